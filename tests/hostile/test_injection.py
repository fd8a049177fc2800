"""Expressions that try to run code: refused wherever one may stand, and nothing is run."""

import sys
from pathlib import Path

import pytest

import racs_bif as rb
from racs_bif.errors import ModelError
from racs_bif.symbolic.strings import parse

CORPUS = [
    "__import__('os').system('touch PWNED')",
    "__import__('pathlib').Path('PWNED').touch()",
    "open('PWNED', 'w')",
    "open('PWNED', 'w').write('x')",
    'exec(\'open("PWNED", "w")\')',
    'eval(\'open("PWNED", "w")\')',
    "compile('1', 'x', 'eval')",
    "globals()['__builtins__']",
    "().__class__.__bases__[0].__subclasses__()",
    "''.__class__.__mro__[1].__subclasses__()",
    "x.__class__",
    "x.__init__.__globals__",
    "(1).__class__",
    "x.free_symbols",
    "x.subs(x, 1)",
    "x.func",
    "sin.__globals__",
    "getattr(x, 'func')",
    "setattr(x, 'func', 1)",
    "delattr(x, 'func')",
    "vars()",
    "locals()",
    "dir(x)",
    "type(x)",
    "input()",
    "breakpoint()",
    "exit()",
    "quit(3)",
    "help(x)",
    "print(x)",
    "memoryview(x)",
    'sympify(\'__import__("os").system("touch PWNED")\')',
    "Symbol('x')",
    "lambdify(x, x)",
    'S(\'open("PWNED", "w")\')',
    "lambda: open('PWNED', 'w')",
    "(lambda: open('PWNED', 'w'))()",
    "(lambda y: y)(x)",
    "f'{open(chr(80), chr(119))}'",
    "f'{x!r}'",
    "rf'{x}'",
    "[open('PWNED', 'w') for _ in (1,)]",
    "[x for x in ().__class__.__bases__]",
    "{x: open('PWNED', 'w') for x in (1,)}",
    "{open('PWNED', 'w')}",
    "(x for x in y)",
    "(z := open('PWNED', 'w'))",
    "(x := 1)",
    "x if open('PWNED', 'w') else y",
    "x if (lambda: 1)() > 0 else y",
    "x[open('PWNED', 'w')]",
    "x[0]",
    "x[::2]",
    "*x",
    "**x",
    "sin(*open('PWNED', 'w'))",
    "sin(**{'x': 1})",
    "sin(x=open('PWNED', 'w'))",
    "x; open('PWNED', 'w')",
    "x\nopen('PWNED', 'w')",
    "x\n__import__('os').system('touch PWNED')",
    "x # y\n+ open('PWNED', 'w')",
    "x \\\n; open('PWNED', 'w')",
    "x\\",
    "\\x6f\\x70\\x65\\x6e('PWNED', 'w')",
    "x\x00open('PWNED', 'w')",
    "x\x0copen('PWNED', 'w')",
    "ｏｐｅｎ('PWNED', 'w')",  # noqa: RUF001 - full width letters
    "ｅｖａｌ(x)",  # noqa: RUF001
    "＿＿import＿＿('os')",  # noqa: RUF001
    "x．__class__",  # noqa: RUF001
    "ехр(x)",  # noqa: RUF001 - Cyrillic letters
    "\u202ex\u202c",
    "x\u200by",
    "import os",
    "from os import system",
    "def f(): pass",
    "class X: pass",
    "del x",
    "raise x",
    "assert x",
    "return x",
    "yield x",
    "await x",
    "with x: pass",
    "while 1: pass",
    "for x in y: pass",
    "try: x",
    "global x",
    "x = 1",
    "x += 1",
    "x: int",
    "@x",
    "x @ y",
    "x -> y",
    "...",
    "`x`",
    "$x",
    "%x",
    "{{x}}",
    "${x}",
    "#{x}",
    "'; DROP TABLE models; --",
    "9**9**9**9",
    "9^9^9^9",
    "(9**999)**999",
    "((2**900)**900)**900",
    "10**10**10*x",
    "x**(9**9**9)",
    "1e999999",
    "9" * 5000,
    "*".join(["9" * 900] * 20),
    "(" * 3000 + "x" + ")" * 3000,
    "-" * 10_000 + "x",
    "[" * 3000 + "]" * 3000,
    "sin(" * 3000,
    "x+" * 9000 + "x",
    "x" * 30_000,
    "x**" * 4000 + "x",
    "x if " * 2000 + "x",
    "factorial(9999999)",
    "gamma(x)",
    "Integral(x, x)",
    "solve(x)",
    "0x" + "f" * 4000,
    "1_" * 3000 + "1",
    "True",
    "None",
    "'x'*9**9",
    "b'x'",
    "x == y",
    "x and open('PWNED', 'w')",
    "not x",
    "~x",
    "x // y",
    "x % y",
    "x << 9999",
    "x | y",
]
PLACES = {
    "equation": "[equations]\nx = {0}\n[parameters]\ny = 1\n",
    "output": "[equations]\nx = '-x*y'\n[parameters]\ny = 1\n[outputs]\nz = {0}\n",
    "term": "[equations]\nx = '-x*y'\n[parameters]\ny = 1\n[terms]\nz = {0}\n",
    "law": "[equations]\nx = '-w*y'\n[parameters]\ny = 1\n[elements.w]\ninput = 'x'\nlaw = {0}\n",
    "input": "[equations]\nx = '-w*y'\n[parameters]\ny = 1\n[elements.w]\nlaw = 's'\ninput = {0}\n",
    "derived": "[equations]\nx = '-x*y'\n[parameters]\ny = 1\n[derived.z]\nsets = 'y'\n"
    "expression = {0}\n",
    "mass": "mass = [[{0}]]\n[equations]\nx = '-x*y'\n[parameters]\ny = 1\n",
}


@pytest.fixture
def watched(tmp_path, monkeypatch):
    """Work in an empty folder; nothing may be in it at the end, nor any module be imported."""
    (tmp_path / "in").mkdir()
    monkeypatch.chdir(tmp_path / "in")
    ran = []
    watching = [True]

    def hook(event, arguments):
        if watching[0] and event in {"os.system", "subprocess.Popen", "os.exec", "socket.connect"}:
            ran.append((event, arguments))

    sys.addaudithook(hook)
    yield tmp_path
    watching[0] = False
    assert ran == []
    assert list(Path().iterdir()) == []


def toml_text(text):
    """Write a text as TOML does."""
    escaped = "".join(c if c.isprintable() and c not in '"\\' else f"\\u{ord(c):04x}" for c in text)
    return f'"{escaped}"'


def check(error):
    message = str(error.value)
    assert "\n" not in message
    assert message.isprintable()
    assert len(message) < 500


@pytest.mark.parametrize("text", CORPUS, ids=range(len(CORPUS)))
def test_as_strings(text, watched):
    with pytest.raises(ModelError) as error:
        parse(text)
    check(error)
    with pytest.raises(ModelError) as error:
        rb.model_from_strings("bad", {"x": text}, parameters={"y": 1.0})
    check(error)
    assert "x" in str(error.value)


@pytest.mark.parametrize("text", CORPUS, ids=range(len(CORPUS)))
def test_in_every_place_of_a_file(text, watched):
    for place, form in PLACES.items():
        path = watched / f"{place}.toml"
        path.write_text(form.format(toml_text(text)), encoding="utf-8")
        with pytest.raises(ModelError) as error:
            rb.model_from_toml(path)
        check(error)


@pytest.mark.parametrize("text", CORPUS[:60:4], ids=range(0, 60, 4))
def test_through_the_command_line(text, command):
    status, said = command(PLACES["equation"].format(toml_text(text)), "bad.toml", parameter="y")
    assert status == 2
    assert len(said.splitlines()) == 1
    assert not Path("PWNED").exists()


@pytest.mark.parametrize("text", CORPUS[:12])
def test_as_names(text, watched):
    with pytest.raises(ModelError, match="cannot be a name"):
        rb.model_from_strings("bad", {"x": "-x"}, parameters={text: 1.0})
    with pytest.raises(ModelError, match="cannot be a name"):
        rb.model_from_strings("bad", {text: "1"}, parameters={})


def test_what_a_model_prints_is_not_run(watched, capsys):
    """Equations are read back for people: what is printed must not be evaluated either."""
    from racs_bif.cli.main import main

    path = watched / "print.toml"
    names = "\n".join(f"{n} = 1.0" for n in ("E", "I", "S", "N", "exp", "sin", "lambda"))
    path.write_text(
        f"title = \"__import__('os').system('touch PWNED')\"\n"
        f'[equations]\nx = "-x*E*exp(I) + S*N*sin(exp) + lambda"\n[parameters]\n{names}\n',
        encoding="utf-8",
    )
    assert main(["models", str(path)]) == 0
    assert "x' = " in capsys.readouterr().out
