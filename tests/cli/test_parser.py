import argparse

import pytest

from racs_bif.cli.main import VERBS, build_parser
from racs_bif.cli.parser import assignment, choice, count, number
from racs_bif.errors import UsageError


def _parse(*arguments):
    return build_parser()[0].parse_args(arguments)


@pytest.mark.parametrize(
    "text", ["-1e-3", "-1", "-.5", "-2.", "-1E+5", "-2.5e-3", "-1_000.5", "-0"]
)
def test_negative_numbers_are_numbers(text):
    parsed = _parse("continue", "p", text, "30", "--at", text, "1", "--set", f"x={text}")
    assert parsed.low == float(text)
    assert parsed.high == 30.0
    assert parsed.at == [("", float(text)), ("", 1.0)]
    assert parsed.values == [("x", float(text))]


def test_negative_numbers_in_pairs():
    parsed = _parse("calibrate", "C", "--hopf", "u=-1e-2", "--span", "-3e2", "-1e-2")
    assert parsed.span == [-300.0, -0.01]
    assert parsed.hopf == [("u", -0.01)]


@pytest.mark.parametrize("text", ["inf", "-inf", "nan", "-nan", "Infinity", "-Infinity", "1e999"])
def test_infinite_values_are_refused_as_such(text):
    with pytest.raises(UsageError, match=r"LOW: .* is not finite"):
        _parse("continue", "p", text, "30")
    with pytest.raises(UsageError, match=r"--set: x: .* is not finite"):
        _parse("continue", "p", "1", "30", "--set", f"x={text}")


@pytest.mark.parametrize("text", ["x", "", "1,5", "1e", "--", "0x10"])
def test_what_is_no_number_is_named(text):
    with pytest.raises(argparse.ArgumentTypeError, match="is not a number"):
        number(text)


@pytest.mark.parametrize("text", ["c", "=3", " =3", ""])
def test_an_assignment_has_a_name_and_a_value(text):
    with pytest.raises(argparse.ArgumentTypeError, match="is not NAME=VALUE"):
        assignment(text)
    with pytest.raises(argparse.ArgumentTypeError, match="c: 'x' is not a number"):
        assignment("c=x")
    assert assignment("c = 0.3") == ("c", 0.3)


@pytest.mark.parametrize("text", ["0", "-1", "2.5", "many"])
def test_a_count_is_at_least_one(text):
    with pytest.raises(argparse.ArgumentTypeError, match="at least 1"):
        count(text)
    assert count("12") == 12


def test_a_choice_names_the_nearest():
    with pytest.raises(argparse.ArgumentTypeError, match="did you mean 'shooting'"):
        choice("shooting", "none")("shoting")
    assert choice("shooting", "none")("none") == "none"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["u", "5", "30", "--modle", "racs"],
            r"unknown option '--modle'; did you mean '--model'\?",
        ),
        (["--modle=racs", "u", "5", "30"], "did you mean '--model'"),
        (["u", "5", "30", "-x"], "unknown option '-x'"),
        (["u", "5", "30", "--vari", "paper"], "did you mean '--variant'"),
    ],
)
def test_unknown_options_are_named_before_anything_else(arguments, message):
    parser = build_parser()[1]["continue"]
    with pytest.raises(UsageError, match=message):
        parser.check_options(arguments)


def test_known_options_and_numbers_pass():
    parser = build_parser()[1]["continue"]
    parser.check_options(["p", "-1e-3", "-inf", "--set=x=1", "--at", "-2", "--", "--whatever"])


@pytest.mark.parametrize("verb", [None, *VERBS])
def test_every_argument_has_help(verb):
    parser, verbs = build_parser()
    parser = verbs[verb] if verb else parser
    assert parser.description
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            assert {choice.dest for choice in action._choices_actions} == set(VERBS)
            assert all(choice.help for choice in action._choices_actions)
        else:
            assert action.help, f"{verb} {action.option_strings or action.dest} has no help"
    assert all(option in parser.format_help() for option in parser.options)
