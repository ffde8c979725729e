"""The tables, plots and captions of sender.py, from its CSV files."""

import csv
import json
import statistics

PARTS = ("base", "decode IDs", "find splits", "visibility", "front update", "encode IDs", "total")
AS_PUBLISHED = "as published: front tested each batch; published IDs"
TABLE_1 = ("Cheng and Ooi 2008 measured 24 % less processor time with receivers that decide, on other machines and code; their "
           "times by part were not at hand. ")
SHORTEST = "tags; adaptive"
KIM = "Kim, Lee and Kobbelt 2004 show it as a plot of other meshes; its numbers were not at hand. "
TAGS = "sender-driven, windowed tags"
FRONT = "sender-driven, vertex front"
ALL_VERTICES = "sender-driven, all active vertices"
ONE_WINDOW = "sender-driven, one window"


def read(output, name):
    with (output / name).open(newline="") as lines:
        return list(csv.DictReader(lines))


def rows_of(rows, **where):
    return [row for row in rows if all(row[key] == value for key, value in where.items())]


def number(rows, column, **where):
    found = rows_of(rows, **where)
    return float(found[0][column]) if found else None


def tell_cost(files, output, mesh):
    rows = rows_of(read(output, "sender_cost.csv"), mesh=mesh)
    ours = rows_of(rows, way="receiver-driven")
    totals = {row["variant"]: float(row["ns_per_record"]) for row in rows_of(rows, way="sender-driven", part="total")}
    best = min((name for name in totals if name != AS_PUBLISHED), key=totals.get)
    table = f"Sender's processor time, the whole mesh, by part: {mesh}"
    for label, chosen in (("receiver-driven (ours)", ours),
                          (f"sender-driven ({best})", rows_of(rows, way="sender-driven", variant=best)),
                          ("sender-driven, as published", rows_of(rows, variant=AS_PUBLISHED))):
        for part in PARTS:
            files.figure(1, table=table, row=label, column=part, value=round(number(chosen, "ns_per_record", part=part), 1),
                         unit="ns a record", csv="sender_cost.csv",
                         note=TABLE_1 + "Each total is of a run without clocks, the best of some, so that parts may add up to more. "
                         "Copying the records counts as finding splits.")
    own = number(ours, "ns_per_record", part="total")
    for label, total, note in (
            ("receiver-driven / sender-driven", totals[best],
             f"Against the cheapest sender-driven variant ({best}): flat arrays, candidates kept in a queue, each node tested once."),
            ("receiver-driven / sender-driven with the shortest IDs", totals[SHORTEST],
             "Against the variant that sends the fewest octets, whose curves the experiments 2, 3 and 9 show."),
            ("receiver-driven / sender-driven as published", totals[AS_PUBLISHED],
             "Against a sender that tests its whole front for each batch and codes each ID by itself.")):
        files.figure(1, table="Sender's processor time a record, the whole mesh", row=mesh, column=label,
                     value=round(own / total, 3), unit="ratio", published=0.76, goal=0.1, goal_is="at most",
                     csv="sender_cost.csv", note=TABLE_1 + note)


def tell_receivers(files, output, mesh):
    for row in rows_of(read(output, "receivers.csv"), mesh=mesh):
        for column, name, unit in (("sender-driven", "sender_ms_a_receiver", "ms"),
                                   ("receiver-driven", "service_ms_a_receiver", "ms"), ("ratio", "ratio", "ratio")):
            files.figure(1, table=f"Sender's processor time a receiver: {mesh}", row=f"{row['receivers']} receivers, {row['views']} views, {row['variant']}",
                         column=column, value=round(float(row[name]), 3), unit=unit, csv="receivers.csv",
                         note="Half a turn in so many views, each receiver on a path of its own; the same records by both ways. "
                         "A sender that decides tests anew at each view, one that is asked works for records alone.")


def tell_bytes(files, output, mesh):
    rows = rows_of(read(output, "bytes.csv"), mesh=mesh, order="error", criteria="0")
    ours = {row["view"]: row for row in files.rows("our_bytes.csv") if row["mesh"] == mesh}
    whole = rows_of(rows, view="all")
    table = "Bits of IDs and records, the whole mesh"
    note = "27 and 32 bits are of the Buddha's, 543,000 splits. "
    for coding in ("published", "bitstring", "adaptive"):
        files.figure(2, table=table, row=mesh, column=f"an ID, sender-driven, {coding}", unit="bits",
                     value=round(number(whole, "id_bits_a_record", ids=coding), 2),
                     published=27 if coding == "published" else None, csv="bytes.csv",
                     note=note + "The sender names each split that it sends. published: tree and path; bitstring: as our requests; "
                     "adaptive: arithmetic code along the hierarchy.")
    files.figure(2, table=table, row=mesh, column="an ID, ours, upwards", value=round(ours["all"]["id_bits_a_record"], 2),
                 unit="bits", published=27, csv="our_bytes.csv", note=note + "Sets of nodes as bitstrings, before base64url.")
    files.figure(2, table=table, row=mesh, column="a record", value=round(number(whole, "record_bits_a_record", ids="published"), 2),
                 unit="bits", published=32, csv="bytes.csv", note=note + "Ours hold levels of significance too.")
    with_criteria = rows_of(read(output, "bytes.csv"), mesh=mesh, order="error", criteria="1", view="all", ids="adaptive")
    files.figure(2, table=table, row=mesh, column="criteria, sender-driven", unit="bits", csv="bytes.csv",
                 value=round(float(with_criteria[0]["criterion_bits_a_record"]), 2),
                 note="Sphere, cone and error of a node, if the client is to coarsen by the sender's criterion; differences from the parent's.")
    for view, row in ours.items():
        table = "Octets, all in" if view == "all" else f"Octets until the view is settled: {view}"
        note = ("Base mesh included; ours with HTTP headers, over meshfront-view and meshfront-serve. Which records a view "
                "needs is decided differently: by pixels covered, or by frustum, cone and error (tolerance 0).")
        for column, value, source in (("down, ours", row["bytes_down"], "our_bytes.csv"), ("up, ours", row["bytes_up"], "our_bytes.csv"),
                                      ("records, ours", row["records"], "our_bytes.csv"),
                                      ("down, sender-driven", number(rows, "bytes_down", view=view, ids="adaptive"), "bytes.csv"),
                                      ("up, sender-driven", number(rows, "bytes_up", view=view, ids="adaptive"), "bytes.csv"),
                                      ("records, sender-driven", number(rows, "records", view=view, ids="adaptive"), "bytes.csv")):
            files.figure(2, table=table, row=mesh, column=column, value=int(value), unit="", csv=source, note=note)
    if "all" in ours:
        for coding, what in (("published", "its published IDs"), ("adaptive", "IDs as short as we could make them")):
            down = number(whole, "bytes_down", ids=coding)
            files.figure(2, table="Octets from the sender, ours / sender-driven, the whole mesh", row=mesh, column=f"with {what}",
                         value=round(ours["all"]["bytes_down"] / down, 3), unit="ratio", csv="our_bytes.csv",
                         published=0.6 if coding == "published" else None,
                         note="Published: 40 % less. Our records are as long as theirs; what is saved are the IDs, as far as there are any.")


def tell_memory(files, output, mesh):
    table = "Server's memory a session, at most along the path"
    for tolerance in ("0", "1"):
        rows = rows_of(read(output, "session.csv"), mesh=mesh, tolerance=tolerance)
        for column, name, note in (
                ("vertex front", "front_bytes", "Four octets an active node that can be split still."),
                ("all active vertices", "all_vertices_bytes", "Four octets a vertex of the client's mesh, leaves too."),
                ("windowed tags", "tags_bytes", "A window for each level, and what the coding of IDs has learned (1.1 KiB)."),
                ("one window", "single_window_bytes", "A single window over all levels, as published: tags alone."),
                ("candidates while sending", "queue_bytes", "Besides, while a view is being answered.")):
            files.figure(6, table=table, row=f"{mesh}, tolerance {tolerance} pixels", column=column, csv="session.csv",
                         value=round(max(int(row[name]) for row in rows) / 1024, 2), unit="KiB", note=KIM + note)
        files.figure(6, table=table, row=f"{mesh}, tolerance {tolerance} pixels", column="ours", value=0, unit="KiB",
                     csv="session.csv", note="The service keeps nothing of a receiver.")
    files.plot(f"session_memory_{mesh}", f"{mesh}: memory a session", "frame", "octets", [
        {"label": label, "csv": "session.csv", "where": {"mesh": mesh, "tolerance": "1"}, "x_column": "frame", "y_column": column}
        for label, column in ((FRONT, "front_bytes"), (ALL_VERTICES, "all_vertices_bytes"), (TAGS, "tags_bytes"),
                              (ONE_WINDOW, "single_window_bytes"))],
        caption="What the server holds of one client along the path, walked twice, at a tolerance of 1 pixel. Ours holds nothing.")


def tell_walk(files, output, mesh):
    table = "Octets along a path that is walked twice"
    rows = rows_of(read(output, "session.csv"), mesh=mesh, tolerance="0")
    walk = [row for row in files.rows("our_walk.csv") if row["mesh"] == mesh]
    for way, source, of in (("sender-driven", "session.csv", rows), ("ours", "our_walk.csv", walk)):
        half, end = of[len(of) // 2 - 1], of[-1]
        for direction in ("down", "up"):
            first, both = int(half[f"bytes_{direction}"]), int(end[f"bytes_{direction}"])
            goal = {"goal": 0, "goal_is": "at most"} if way == "ours" else {}
            note = ("What pixels show of a part depends on how fine the rest is by now; the rim of what is seen is split, too, so "
                    "that it changes little. Ours with HTTP headers." if way == "ours" else "A sender that decides is told each view, needed or not.")
            files.figure(6, table=table, row=mesh, column=f"{way}, {direction}, first time", value=first, unit="", csv=source,
                         note=KIM + note)
            files.figure(6, table=table, row=mesh, column=f"{way}, {direction}, second time", value=both - first, unit="",
                         csv=source, note=KIM + note, **goal)
    files.plot(f"walk_bytes_{mesh}", f"{mesh}: octets along the path, walked twice", "frame", "octets", [
        {"label": f"{way}, {direction}", "csv": source, "where": {"mesh": mesh} | where, "x_column": "frame",
         "y_column": f"bytes_{direction}"}
        for way, source, where in (("ours", "our_walk.csv", {}), ("sender-driven", "session.csv", {"tolerance": "0"}))
        for direction in ("down", "up")],
        caption="Accumulated, base mesh included.", log_y=True)


def tell_client(files, output, mesh):
    rows = rows_of(read(output, "client.csv"), mesh=mesh)
    table = "The client along the path: fewest, median, most"
    for column, name, unit, scale in (("triangles", "triangles", "thousand", 1000), ("refinement", "refinement_ms", "ms", 1),
                                      ("drawing", "drawing_ms", "ms", 1)):
        # Of the first frame all comes at once.
        values = sorted(float(row[name]) / scale for row in rows[1:])
        for what, value in (("fewest", values[0]), ("median", statistics.median(values)), ("most", values[-1])):
            files.figure(6, table=table, row=f"{mesh}, {what}", column=column, value=round(value, 2), unit=unit, csv="client.csv",
                         note=KIM + "All frames but the first. Refinement: ranking, collapsing and splitting a frame; what 20 % of the "
                         "vertices is beyond the picture's need is collapsed and split again from what is kept. Drawn by the machine that the page names.")
    for column, label in (("triangles", "triangles"), ("refinement_ms", "refinement, ms"), ("drawing_ms", "drawing, ms")):
        files.plot(f"client_{column}_{mesh}", f"{mesh}: {label} along the path", "frame", label,
                   [{"label": label, "csv": "client.csv", "where": {"mesh": mesh}, "x_column": "frame", "y_column": column}],
                   caption="Our client along the path, walked twice.")


def tell_pictures(files, output, names):
    pictures = []
    for row in read(output, "pictures.csv"):
        if row["mesh"] not in names:
            continue
        kind = "Fixed tolerance, 1 pixel" if "tolerance" in row["file"] else "Fixed octets"
        if "tolerance_ours" in row["file"]:
            kind = "The same PSNR"
        caption = (f"{row['mesh']}, {kind.lower()}: {row['way']}, {int(row['bytes_down']):,} octets, {int(row['records']):,} records, "
                   f"{int(row['triangles']):,} triangles, {float(row['psnr']):.1f} dB against the whole mesh")
        pictures.append({"file": row["file"], "caption": caption, "experiment": 6})
        table = "Fixed tolerance and fixed octets, the whole in view"
        for column, name in (("octets", "bytes_down"), ("records", "records"), ("PSNR", "psnr")):
            files.figure(6, table=table, row=f"{row['mesh']}, {kind.lower()}: {row['way']}", column=column,
                         value=round(float(row[name]), 2), unit="dB" if name == "psnr" else "", csv="pictures.csv",
                         note="Kim, Lee and Kobbelt 2004, figures 8 and 9, show pictures of other meshes. PSNR is against the published mesh in full.")
    (output / "pictures.json").write_text(json.dumps(pictures, indent=1) + "\n")


def tell_all(files, output, names):
    for mesh in names:
        tell_cost(files, output, mesh)
        tell_receivers(files, output, mesh)
        tell_bytes(files, output, mesh)
        tell_memory(files, output, mesh)
        tell_walk(files, output, mesh)
        tell_client(files, output, mesh)
    tell_pictures(files, output, names)
    files.write()
