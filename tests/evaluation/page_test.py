#!/usr/bin/env python3
"""The page of an evaluation: what is shown, what is escaped, and what is refused."""

import json
import pathlib
import tempfile
import unittest

import page
import page_data

FIGURE = {"experiment": 7, "table": "IDs", "row": "bunny", "column": "bits", "value": 23.5, "unit": "bits",
          "published": 27, "goal": 24, "goal_is": "at most", "csv": "ids.csv", "note": "other mesh"}
PLOT = {"file": "curve", "title": "Curve", "x": "bytes", "y": "dB", "log_x": True, "caption": "A curve.",
        "lines": [{"label": "ours", "csv": "ids.csv", "where": {"mesh": "bunny"}, "x_column": "x", "y_column": "y"}]}


class PageTest(unittest.TestCase):
    def setUp(self):
        self.kept = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.kept.name)
        self.folder = self.root / "tables"
        self.folder.mkdir()
        (self.folder / "ids.csv").write_text("mesh,x,y\nbunny,1,30\nhorse,2,31\nbunny,3,\nbunny,4,36.5\n")

    def tearDown(self):
        self.kept.cleanup()

    def write(self, name, rows):
        (self.folder / name).write_text(json.dumps(rows))

    def page(self, *figures):
        self.write("figures.json", list(figures))
        page.write_page(self.root)
        return (self.root / "index.html").read_text()

    def refused(self, *figures):
        with self.assertRaises(page_data.DataError) as caught:
            self.page(*figures)
        return str(caught.exception)

    def test_shows_ours_beside_published_and_goal(self):
        html = self.page(FIGURE, FIGURE | {"row": "horse", "value": 24.01})
        for part in ("<b>23.5</b>", "published 27", "goal ≤ 24", "1 met, 1 missed", "other mesh",
                     '<a href="tables/ids.csv">ids.csv</a>'):
            self.assertIn(part, html)
        self.assertEqual(len(json.loads((self.root / "figures.json").read_text())), 2)

    def test_a_note_of_all_stands_once_without_marks(self):
        self.assertNotIn("<sup>", self.page(FIGURE, FIGURE | {"row": "horse"}))
        html = self.page(FIGURE, FIGURE | {"row": "horse", "note": "another"}, FIGURE | {"row": "cow", "note": ""})
        self.assertEqual(html.count("<sup>1</sup>"), 1)
        self.assertIn("<li>other mesh</li><li>another</li>", html)

    def test_goals_both_ways_and_on_the_line(self):
        at_least = {"goal_is": "at least"}
        for row, met in ((FIGURE | {"value": 24}, True), (FIGURE | {"value": 24} | at_least, True),
                         (FIGURE | at_least, False), (FIGURE | {"value": None}, None),
                         (FIGURE | {"goal": None, "goal_is": None}, None)):
            self.assertIs(page_data.verdict(row), met)

    def test_escapes_what_it_shows(self):
        html = self.page(FIGURE | {key: f"<i>{key}</i> & \"q\"" for key in ("table", "row", "column", "unit", "note")})
        self.assertNotIn("<i>", html)
        self.assertIn("&lt;i&gt;note&lt;/i&gt; &amp; &quot;q&quot;", html)

    def test_refuses_a_figure_without_its_csv(self):
        self.assertIn("there is no", self.refused(FIGURE | {"csv": "gone.csv"}))
        (self.folder / "empty.csv").write_text("mesh,x,y\n")
        self.assertIn("no data", self.refused(FIGURE | {"csv": "empty.csv"}))
        for path in ("../tables/ids.csv", "/etc/passwd", "", None):
            self.assertIn("no plain file name", self.refused(FIGURE | {"csv": path}))

    def test_refuses_what_is_not_as_described(self):
        self.assertIn("without unit", self.refused({k: v for k, v in FIGURE.items() if k != "unit"}))
        self.assertIn("neither a number", self.refused(FIGURE | {"value": "23"}))
        self.assertIn("neither a number", self.refused(FIGURE | {"value": float("nan")}))
        self.assertIn("goal_is", self.refused(FIGURE | {"goal_is": None}))
        self.assertIn("that there are not", self.refused(FIGURE | {"experiment": 77}))
        (self.folder / "figures.json").write_text("{")
        with self.assertRaises(page_data.DataError):
            page.write_page(self.root)

    def test_says_what_did_not_run(self):
        html = self.page(FIGURE)
        self.assertRegex(html, r'(?s)id="e8">.*?Did not run')
        self.assertRegex(html, r"<th>caching</th><td>did not run</td>")
        failed = self.root / "caching"
        failed.mkdir()
        (failed / "status.json").write_text(json.dumps({"state": "failed", "reason": "no <nginx>"}))
        html = self.page(FIGURE)
        self.assertIn("Did not run to its end: no &lt;nginx&gt;", html)
        self.assertIn("failed: no &lt;nginx&gt;", html)

    def test_plots_and_pictures(self):
        self.write("plots.json", [PLOT])
        self.assertIn("Not drawn", self.page(FIGURE))
        (self.folder / "curve.svg").write_text("<svg/>")
        self.assertIn('<img src="tables/curve.svg"', self.page(FIGURE))
        self.write("pictures.json", [{"file": "gone.png", "caption": ""}])
        self.assertIn("gone.png", self.refused(FIGURE))

    def test_a_plot_stands_by_the_figures_of_its_csv(self):
        (self.folder / "curve.svg").write_text("<svg/>")
        (self.folder / "early.csv").write_text("mesh\nbunny\n")
        early = FIGURE | {"experiment": 1, "csv": "early.csv"}
        for plot, section in ((PLOT, "e7"), (PLOT | {"experiment": 1}, "e1")):
            self.write("plots.json", [plot])
            sections = self.page(early, FIGURE).split("<section ")
            self.assertEqual([part[4:6] for part in sections if "curve.svg" in part], [section])

    def test_points_of_a_line(self):
        line = PLOT["lines"][0]
        self.assertEqual(page_data.line_points(self.folder, line), [(1, 30), (4, 36.5)])
        for wrong in ({"where": {"mesh": "cow"}}, {"where": {"way": "ours"}}, {"y_column": "z"}):
            with self.assertRaises(page_data.DataError):
                page_data.line_points(self.folder, line | wrong)

    def test_numbers_in_words(self):
        for value, shown in ((None, "–"), (0, "0"), (1234567, "1,234,567"), (1234567.8, "1,234,568"), (2345.6, "2,346"),
                             (0.07123, "0.07123"), (17.449, "17.45"), (0.0000012, "1.20e-06")):
            self.assertEqual(page.number(value), shown)

    def test_loads_nothing_from_elsewhere(self):
        self.assertNotRegex(self.page(FIGURE), r'(src|href)="(https?:)?//')


if __name__ == "__main__":
    unittest.main()
