from racs_bif.markup import MOST, card, listed, paragraph, table


def test_everything_is_escaped():
    text = card("<a>", paragraph("b & c"), listed("d", ["<e>"]), table(("<f>",), [("<g>",)]))
    for letter in "aefg":
        assert f"&lt;{letter}&gt;" in text
    assert "b &amp; c" in text


def test_empty_parts_and_columns_are_left_out():
    assert paragraph("") == listed("d", []) == table(("a",), []) == table(("a",), [(None,)]) == ""
    text = table(("a", "b"), [(1.0, float("nan")), (2.0, None)])
    assert "<th>a</th>" in text
    assert "<th>b</th>" not in text


def test_numbers_are_printed_short():
    text = table(("a",), [(1.23456789,), (True,), (7,), ("word",)])
    assert [part in text for part in ("1.23457", "yes", "7", "word")] == [True] * 4


def test_long_tables_say_that_there_is_more():
    text = table(("a",), [(k,) for k in range(MOST + 5)])
    assert text.count("<tr>") == MOST + 2
    assert "and 5 more" in text
    assert "and 3 more" in listed("d", ["x"] * (MOST + 3))
