"""The corpus of scripts/corpus.py: two versions are compared."""

from scripts import corpus


def test_the_corpus_lists_texts_that_differ(tmp_path, capsys):
    for name, text in (("old", "a\nb\n"), ("new", "a\nc\n")):
        (tmp_path / name / "texts").mkdir(parents=True)
        (tmp_path / name / "texts" / "run.txt").write_text(text)
        (tmp_path / name / "texts" / "same.txt").write_text("same")
    (tmp_path / "new" / "texts" / "more.txt").write_text("more")
    assert corpus.compare(tmp_path / "old", tmp_path / "new") == 1
    printed = capsys.readouterr().out
    assert "== more.txt: only in" in printed
    assert "== run.txt\n" in printed
    assert "\n-b\n+c\n" in printed
    assert "same.txt" not in printed
    assert printed.endswith("1 of 3 texts differ\n")


def test_the_corpus_leaves_times_out(tmp_path):
    (tmp_path / "a.csv").write_text("# a sweep\nid,seconds,P\n1,0.25,3.0\n")
    assert corpus.without_times(tmp_path / "a.csv") == "# a sweep\nid,P\n1,3.0"
