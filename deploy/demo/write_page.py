"""Makes the demo's page from what its runs left in a folder, and prints the summary.

    python3 write_page.py FOLDER

The folder holds, as demo.sh writes them: encode.json; for each run NAME.json, NAME.png and
NAME.metrics (the proxy's counters after it); the traces settled.csv and pixels.csv.
"""

import html
import json
import pathlib
import sys

import png_strip
import psnr_plot

IDENTICAL = 100  # dB that stand for equal pictures

STYLE = """
:root { color-scheme: light dark; --text: #1b1f24; --soft: #59636e; --line: #d5dae0;
  --back: #ffffff; --card: #f5f7f9; --first: #2563eb; --second: #c2570c; }
@media (prefers-color-scheme: dark) { :root { --text: #e8eaed; --soft: #9aa4b0; --line: #353c45;
  --back: #14171a; --card: #1d2126; --first: #7aa5ff; --second: #f0924e; } }
body { margin: 0 auto; padding: 2rem 1.25rem 4rem; max-width: 62rem; background: var(--back);
  color: var(--text); font: 16px/1.5 system-ui, sans-serif; }
h1 { margin: 0 0 .25rem; font-size: 1.6rem; line-height: 1.2; }
h2 { margin: 2.5rem 0 .75rem; font-size: 1.15rem; }
p { margin: .25rem 0 1rem; max-width: 46rem; }
.steps { display: grid; grid-template-columns: repeat(4, 1fr); gap: 1rem; }
@media (max-width: 52rem) { .steps { grid-template-columns: repeat(2, 1fr); } }
figure { margin: 0; background: var(--card); border: 1px solid var(--line); border-radius: 6px;
  overflow: hidden; }
figure img { display: block; width: 100%; height: auto; }
figcaption { padding: .6rem .75rem .75rem; font-size: .875rem; color: var(--soft); }
figcaption b { display: block; color: var(--text); font-size: 1rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .925rem; }
th, td { padding: .35rem .9rem .35rem 0; border-bottom: 1px solid var(--line); text-align: right; }
th { font-weight: 600; } th:first-child, td:first-child { text-align: left; }
.wide { margin-bottom: 1rem; overflow-x: auto; }
code, pre { font: .875rem/1.5 ui-monospace, monospace; }
pre { padding: .75rem 1rem; background: var(--card); border: 1px solid var(--line);
  border-radius: 6px; overflow-x: auto; }
svg { width: 100%; height: auto; } svg text { font: 12px system-ui, sans-serif; fill: var(--soft); }
.grid { stroke: var(--line); } .target { stroke: var(--soft); stroke-dasharray: 5 4; }
.first, .second { fill: none; stroke-width: 2; }
.first { stroke: var(--first); } .second { stroke: var(--second); stroke-dasharray: 7 3; }
.mark { fill: var(--first); stroke: var(--back); stroke-width: 2; }
"""


class Demo:
    """What the runs left."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.encoding = self.read_json("encode")
        self.mesh = self.encoding["metadata"]

    def read_json(self, name):
        return json.loads((self.folder / f"{name}.json").read_text(encoding="utf-8"))

    def counters(self, run):
        """The proxy's counters after a run, by name with labels."""
        text = (self.folder / f"{run}.metrics").read_text(encoding="utf-8")
        lines = [line.rsplit(" ", 1) for line in text.splitlines() if not line.startswith("#")]
        # Sums of seconds have fractions; what is read here are counts.
        return {name: int(float(value)) for name, value in lines}

    def upstream_record_requests(self, run):
        """How often the proxy had asked the service for records, up to the end of a run."""
        counters = self.counters(run)
        return sum(counters.get(f'meshfront_upstream_requests_total{{kind="{kind}"}}', 0)
                   for kind in ("splits", "chunk"))

    def record_hits(self, run):
        return self.counters(run).get("meshfront_cache_record_hits_total", 0)


def grouped(number):
    return f"{number:,}"


def kilobytes(octets):
    return f"{octets / 1000:,.1f} kB"


def percent(share):
    return f"{100 * share:.1f} %"


def decibels(psnr):
    return "identical" if psnr >= IDENTICAL else f"{psnr:.1f} dB"


def figure(name, title, run):
    return (f'<figure><img src="{name}.png" alt="{html.escape(title)}" width="500" height="500">'
            f"<figcaption><b>{html.escape(title)}</b>"
            f"{grouped(run['records'])} records, {percent(run['share'])} of all<br>"
            f"{kilobytes(run['bytes_down'])} down, {kilobytes(run['bytes_up'])} up<br>"
            f"{grouped(run['triangles'])} triangles, {decibels(run['psnr'])}</figcaption></figure>")


def table(head, rows):
    def line(cells, kind):
        return "<tr>" + "".join(f"<{kind}>{cell}</{kind}>" for cell in cells) + "</tr>"
    return ('<div class="wide"><table><thead>' + line(head, "th") + "</thead><tbody>" +
            "".join(line(row, "td") for row in rows) + "</tbody></table></div>")


def page(demo, runs, plot, viewers):
    mesh = demo.mesh
    bits = demo.encoding["bitsPerSplit"]
    seconds = sum(phase["seconds"] for phase in demo.encoding["phases"])
    first, second = viewers
    pictures = [("base", "Base mesh"), ("five-percent", "5 % of the records"),
                ("35-db", "35 dB reached"), ("settled", "Settled")]
    return f"""<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>meshfront demo: {html.escape(mesh['name'])}</title>
<style>{STYLE}</style>
<h1>{html.escape(mesh['name'])}, streamed for one view</h1>
<p>{grouped(mesh['triangleCount'])} triangles were encoded, served, and streamed through a caching
proxy to a viewer that asked for what its picture lacked. PSNR is against the same view of the
input file.</p>
<div class="steps">
{"".join(figure(name, title, runs[name]) for name, title in pictures)}
</div>
<h2>Quality against bytes</h2>
<p>A viewer asks for coarse, significant detail first. The published order, by covered pixels alone,
spends its first bytes on flat parts that happen to be large.</p>
{plot}
<h2>Two viewers, one view</h2>
{table(["", "first viewer", "second viewer"], [
    ["records received", *(grouped(v["records"]) for v in viewers)],
    ["share of all records", *(percent(v["share"]) for v in viewers)],
    ["requests for records", *(grouped(v["requests"]) for v in viewers)],
    ["bytes up", *(grouped(v["bytes_up"]) for v in viewers)],
    ["bytes down", *(grouped(v["bytes_down"]) for v in viewers)],
    ["bytes down without headers", *(grouped(v["bytes_down"] - v["header_bytes_down"])
                                     for v in viewers)],
    ["record requests from proxy to service", *(grouped(v["upstream"]) for v in viewers)],
    ["records that the proxy had in its cache", *(grouped(v["hits"]) for v in viewers)],
    ["time, drawing and counting included", *(f"{v['seconds']:.1f} s" for v in viewers)],
])}
<p>The first viewer also compared its picture with the reference after every answer, which takes
part of its time.</p>
<h2>Encoding</h2>
{table(["triangles", "vertices", "base mesh", "records", "bits a record", "time"], [[
    grouped(mesh["triangleCount"]), grouped(mesh["vertexCount"]),
    f"{grouped(mesh['baseTriangleCount'])} triangles, {grouped(mesh['baseBytes'])} bytes",
    f"{grouped(mesh['splitCount'])} in {grouped(mesh['recordBytes'])} bytes",
    f"{bits['total']:.1f}", f"{seconds:.2f} s"]])}
<h2>Look yourself</h2>
<pre>build/bin/meshfront-serve --packs demo-out/packs
build/bin/meshfront-view http://127.0.0.1:8080/v1/meshes/{html.escape(mesh['name'])}</pre>
<p>Beside this page lie the pictures, a summary of each run (<code>*.json</code>), the traces
(<code>settled.csv</code>, <code>pixels.csv</code>), the proxy's counters after each run
(<code>*.metrics</code>) and the servers' logs.</p>
<p>Drawn with {html.escape(first['renderer'])}. Bunny: Stanford Computer Graphics Laboratory,
Stanford 3D Scanning Repository.</p>
</html>
"""


def summary(demo, runs, viewers):
    mesh = demo.mesh
    bits = demo.encoding["bitsPerSplit"]

    def line(title, run):
        return (f"{title:<15} {grouped(run['records']):>6} records ({percent(run['share']):>7}), "
                f"{kilobytes(run['bytes_down']):>9} down, {decibels(run['psnr'])}")
    first, second = viewers
    return [
        f"mesh            {mesh['name']}: {grouped(mesh['triangleCount'])} triangles, "
        f"{grouped(mesh['splitCount'])} records of {bits['total']:.1f} bits",
        line("base mesh", runs["base"]),
        line("5 %", runs["five-percent"]),
        line("35 dB", runs["35-db"]),
        line("settled", runs["settled"]),
        line("by pixels only", runs["pixels"]),
        f"first viewer    {first['requests']} requests for records, {kilobytes(first['bytes_up'])} "
        f"up; {first['upstream']} went on to the service",
        f"second viewer   {second['requests']} requests for records; {second['upstream']} went on "
        f"to the service, {grouped(second['hits'])} records from the proxy's cache",
        f"time            encode {sum(p['seconds'] for p in demo.encoding['phases']):.2f} s, "
        f"second viewer {second['seconds']:.1f} s",
        f"page            {(demo.folder / 'index.html').resolve()}",
    ]


def main(folder):
    demo = Demo(folder)
    names = ("settled", "second", "base", "five-percent", "35-db", "pixels")
    runs = {name: demo.read_json(name) for name in names}
    first, second = dict(runs["settled"]), dict(runs["second"])
    first["upstream"] = demo.upstream_record_requests("settled")
    first["hits"] = demo.record_hits("settled")
    second["upstream"] = demo.upstream_record_requests("second") - first["upstream"]
    second["hits"] = demo.record_hits("second") - first["hits"]

    plot = psnr_plot.plot(
        [psnr_plot.Series("significance, then pixels", "first",
                          psnr_plot.points_of(demo.folder / "settled.csv")),
         psnr_plot.Series("pixels alone (published order)", "second",
                          psnr_plot.points_of(demo.folder / "pixels.csv"))],
        [(runs[name]["bytes_down"], min(runs[name]["psnr"], IDENTICAL), label)
         for name, label in (("base", "base mesh"), ("five-percent", "5 %"), ("35-db", "35 dB"),
                             ("settled", "settled"))],
        target=35)
    text = page(demo, runs, plot, (first, second))
    (demo.folder / "index.html").write_text(text, encoding="utf-8")
    png_strip.join(demo.folder / "strip.png",
                   [demo.folder / f"{name}.png"
                    for name in ("base", "five-percent", "35-db", "settled")])
    print("\n".join(summary(demo, runs, (first, second))))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
