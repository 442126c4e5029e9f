"""The list of tests that ``make test`` leaves out, and what is said where it names one that is not there."""

from __future__ import annotations

from thorough import LIST, unknown

HERE = {"a.py::one", "a.py::two[1]", "b.py::three"}


def test_the_list_is_in_order_and_names_each_once() -> None:
    lines = LIST.read_text(encoding="utf-8").splitlines()
    assert lines == sorted(set(lines))
    assert all(line.startswith("tests/") and "::test_" in line for line in lines)


def test_a_name_that_no_test_has_is_found_in_files_taken_whole() -> None:
    listed = {"a.py::two[1]", "a.py::gone", "c.py::elsewhere"}
    assert unknown(listed, HERE, ["a.py", "b.py"]) == {"a.py::gone"}
    assert unknown(listed, HERE, ["a.py::one"]) == set()
    assert unknown(listed - {"a.py::gone"}, HERE, []) == set()
