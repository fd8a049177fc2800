import pytest

from racs_bif.errors import UsageError
from racs_bif.shelf import find, folders, names

FOLDERS = ("models", "analyses")


def test_the_vehicle_is_on_the_shelf():
    assert names("models")["racs"] == find("models", "racs")
    assert find("models", "racs").name == "racs.py"


def test_subfolders_of_an_entry_hold_one_kind_each(tmp_path, shelve, model_source):
    for kind in ("models", "analyses"):
        (tmp_path / kind).mkdir()
        (tmp_path / kind / f"{kind}_file.py").write_text(model_source, encoding="utf-8")
    shelve(tmp_path)
    assert "models_file" in names("models")
    assert "models_file" not in names("analyses")
    assert "analyses_file" in names("analyses")
    assert "analyses_file" not in names("models")


def test_an_entry_itself_is_sorted_by_what_its_files_define(
    tmp_path, shelve, model_source, analysis_source
):
    (tmp_path / "duffing.py").write_text(model_source, encoding="utf-8")
    (tmp_path / "sweep.py").write_text(analysis_source, encoding="utf-8")
    (tmp_path / "setup.py").write_text("x = 1\n", encoding="utf-8")
    shelve(tmp_path)
    own = {kind: {n for n, p in names(kind).items() if p.parent == tmp_path} for kind in FOLDERS}
    assert own == {"models": {"duffing"}, "analyses": {"sweep"}}


def test_a_broken_file_in_a_models_folder_is_listed(tmp_path, shelve):
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "typo.py").write_text("def modle(): ...\n", encoding="utf-8")
    shelve(tmp_path / "models")
    assert "typo" in names("models")
    assert "typo" not in names("analyses")


def test_helpers_are_not_listed(tmp_path, shelve, model_source):
    (tmp_path / "_shared.py").write_text(model_source, encoding="utf-8")
    shelve(tmp_path)
    assert "_shared" not in names("models")


def test_a_path_is_taken_as_it_is(tmp_path, model_source):
    file = tmp_path / "anything.py"
    file.write_text(model_source, encoding="utf-8")
    assert find("models", str(file)) == file


def test_an_unknown_name_gets_the_nearest():
    with pytest.raises(UsageError, match=r"unknown model 'rasc': did you mean 'racs'\?"):
        find("models", "rasc")


def test_a_missing_file_is_named():
    with pytest.raises(UsageError, match=r"no file 'nowhere/duffing\.py': check the path"):
        find("models", "nowhere/duffing.py")
    with pytest.raises(UsageError, match=r"no file 'lost/racs\.py': did you mean the model 'racs'"):
        find("models", "lost/racs.py")


def test_a_name_found_twice_names_both_files(tmp_path, shelve, model_source):
    files = []
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        files.append(tmp_path / folder / "duffing.py")
        files[-1].write_text(model_source, encoding="utf-8")
    shelve(tmp_path / "one", tmp_path / "two")
    for ask in (lambda: find("models", "duffing"), lambda: names("models")):
        with pytest.raises(UsageError, match="found twice") as caught:
            ask()
        assert all(str(file) in str(caught.value) for file in files)
    # the others can still be used
    assert find("models", "racs").name == "racs.py"


def test_an_entry_named_twice_counts_once(tmp_path, shelve, model_source):
    (tmp_path / "duffing.py").write_text(model_source, encoding="utf-8")
    shelve(tmp_path, "", tmp_path / ".." / tmp_path.name)
    assert folders("models").count(tmp_path.resolve()) == 1
    assert find("models", "duffing") == tmp_path / "duffing.py"


def test_an_entry_that_is_lost_is_mentioned(tmp_path, shelve):
    shelve(tmp_path / "gone")
    with pytest.raises(UsageError, match=r"RACS_BIF_PATH names .*gone: no such folder"):
        find("models", "duffing")
