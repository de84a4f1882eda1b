"""Markdown tables of the benchmark, and the list of measurements."""

import statistics

# x, y, z, time and tilt of eight bytes, intensity and ring of one.
POINT_BYTES = 42
OURS, DECODER, LIDAR = "velomotion", "velodyne-decoder", "velodyne-lidar"

# Section, program, name of the work, description.
WORK = [
    ("memory", DECODER, "handed on, floats", "one revolution at a time, rows of f32"),
    ("memory", DECODER, "handed on, structs", "one revolution at a time, structs"),
    ("memory", DECODER, "kept, structs", "one revolution at a time, structs, all kept"),
    ("memory", LIDAR, "handed on", "one revolution at a time"),
    ("memory", LIDAR, "kept", "one revolution at a time, all kept"),
    ("memory", OURS, "blocks", "firing blocks only, no points"),
    ("memory", OURS, "sensor, handed on", "sensor frame, in batches"),
    ("memory", OURS, "tilted, handed on", "**tilted, in batches**"),
    ("memory", OURS, "tilted, one cloud", "tilted, one cloud, memory in use before"),
    ("memory", OURS, "tilted, one new cloud", "tilted, one cloud, new memory"),
    ("file", DECODER, "file, floats", "read_pcap, rows of f32"),
    ("file", DECODER, "file, structs", "read_pcap, structs"),
    ("file", LIDAR, "file", "frame_xyz_iter_from_file"),
    ("file", OURS, "file, sensor", "both passes, sensor frame"),
    ("file", OURS, "file, tilted", "**both passes, tilted**"),
    ("limits", OURS, "write, batch", "columns written, the same batch repeatedly"),
    ("limits", OURS, "write, cloud", "columns written, one cloud"),
    ("limits", OURS, "copy, cloud", "columns copied, batch to cloud"),
    ("limits", OURS, "write, big cloud", "columns written, 512 MiB"),
    ("limits", OURS, "copy, big cloud", "columns copied, 512 MiB"),
    ("limits", OURS, "tilted, big cloud", "**wire bytes to tilted points**, 512 MiB"),
]
# Work of velomotion and the memory limit that it is compared with.
SHARES = [
    ("tilted, handed on", "write, batch"),
    ("tilted, one cloud", "write, cloud"),
    ("tilted, big cloud", "write, big cloud"),
    ("tilted, big cloud", "copy, big cloud"),
]


def spread(values, digits=1):
    return f"{statistics.median(values):.{digits}f} ({min(values):.{digits}f}..{max(values):.{digits}f})"


def rates(entry):
    return [entry["points"] / seconds / 1e6 for seconds in entry["seconds"]]


def rate(result, name):
    """Median, million points a second."""
    section = next(s for s, who, work, _ in WORK if who == OURS and work == name)
    return statistics.median(rates(result["work"][f"{section}/{OURS}/{name}"]))


def core_share(results):
    entries = [entry for result in results for entry in result["work"].values()]
    had, wanted = (sum(sum(entry[key]) for entry in entries) for key in ("seconds", "wall_s"))
    return had / wanted


def best_peer(result, section):
    peers = {
        key: statistics.median(rates(entry))
        for key, entry in result["work"].items()
        if key.startswith(section) and f"/{OURS}/" not in key
    }
    return max(peers.values())


def tables(result):
    info = result["info"]
    mode = {0x37: "strongest", 0x38: "last", 0x39: "dual"}.get(info["return_mode"], "unknown")
    yield f"## {result['recording']}\n"
    yield (
        f"{info['model']}, {mode}: {info['packets']} data packets, {info['channels']} channels, {info['points']} points "
        f"({100 * info['points'] / info['channels']:.0f} % of the channels).\n"
    )
    for section, title in [("memory", "Packets in memory to points in memory"), ("file", "File to points in memory")]:
        best = best_peer(result, section)
        yield f"### {title}\n"
        yield "| | | points | million points/s | ns per point | relative to the best peer |\n|---|---|---:|---:|---:|---:|"
        for of, who, name, what in WORK:
            entry = result["work"].get(f"{of}/{who}/{name}")
            if of != section or entry is None:
                continue
            each = rates(entry)
            median = statistics.median(each)
            yield f"| {who} | {what} | {entry['points']} | {spread(each)} | {1e3 / median:.1f} | {median / best:.2f} |"
        yield ""
    yield from limits(result)
    yield from ply(result)
    yield from equality(result)


def limits(result):
    yield "### Memory bandwidth\n"
    yield f"| {POINT_BYTES} bytes per point | million points/s | GB/s |\n|---|---:|---:|"
    for section, who, name, what in WORK:
        if section == "limits":
            each = rates(result["work"][f"{section}/{who}/{name}"])
            yield f"| {what} | {spread(each)} | {statistics.median(each) * POINT_BYTES / 1e3:.1f} |"
    yield ""
    what = {name: text.replace("*", "") for _, who, name, text in WORK if who == OURS}
    for ours, limit in SHARES:
        share = 100 * rate(result, ours) / rate(result, limit)
        yield f"- {what[ours]}: {rate(result, ours) * POINT_BYTES / 1e3:.1f} GB/s, {share:.0f} % of \"{what[limit]}\""
    yield ""


def read_pcap(result):
    both = [result["work"][f"file/{DECODER}/file, {kind}"] for kind in ("floats", "structs")]
    return min(both, key=lambda entry: statistics.median(entry["seconds"]))


def times(theirs, ours):
    return f"{statistics.median(theirs) / statistics.median(ours):.1f}"


def ply(result):
    theirs = read_pcap(result)
    yield f"### File to PLY file, {result['ply_bytes'] / 1e6:.1f} MB\n"
    yield "| | ms | speed | CPU ms | speed |\n|---|---:|---:|---:|---:|"
    ms = lambda seconds: spread([1e3 * s for s in seconds])
    yield f"| {DECODER}: read_pcap alone, nothing written | {ms(theirs['wall_s'])} | 1 | {ms(theirs['seconds'])} | 1 |"
    of = {"disk": "on disk, synced", "memory": "in memory (tmpfs)"}
    for place, entry in result["ply"].items():
        each = entry["seconds"], entry["cpu_s"]
        wall, cpu = times(theirs["wall_s"], each[0]), times(theirs["seconds"], each[1])
        yield f"| **{OURS} replay --tilt**, the whole program, {of[place]} | {ms(each[0])} | {wall} | {ms(each[1])} | {cpu} |"
        alone = entry["bytes_alone_s"]
        yield f"| plain write of as many bytes, {of[place]} | {ms(alone)} | {times(theirs['wall_s'], alone)} | | |"
    entry = result["ply"]["disk"]
    alone = entry["not_synced_s"]
    yield f"| plain write of as many bytes, on disk, not synced | {ms(alone)} | {times(theirs['wall_s'], alone)} | | |"
    yield f"| start and end of the program only (--version) | {ms(entry['start_s'])} | | | |"
    yield ""


def equality(result):
    same = result["equality"]
    yield f"### Points compared with {DECODER}\n"
    if same["theirs"] != same["ours"]:
        yield f"Different numbers: {same['theirs']} points of {DECODER}, {same['ours']} of {OURS}.\n"
        return
    agree = all(same[f"same_{what}"] for what in ("rings", "packets", "intensities"))
    yield (
        f"{same['ours']} points each; packets, rings and intensities {'agree' if agree else 'DIFFER'} for all. "
        f"Farther than 1 mm apart: {same['over_1_mm']}, at most {same['max_mm']:.2f} mm "
        f"(the farthest point is {same['farthest_m']:.1f} m away).\n"
    )
    yield "| | points | over 1 mm | at most, mm | azimuth difference, deg | theirs from their rule, deg | after azimuth correction, mm | after height correction, mm |\n|---|---:|---:|---:|---:|---:|---:|---:|"
    for name, kind in same["kinds"].items():
        if kind["points"]:
            yield (
                f"| {name} | {kind['points']} | {kind['over_1_mm']} | {kind['max_mm']:.2f} | {kind['max_deg']:.4f} "
                f"| {kind['max_off_rule_deg']:.4f} | {kind['max_turned_mm']:.3f} | {kind['explained_max_mm']:.3f} |"
            )
    yield f"\nHeights of the lasers' origins differ by at most {same['max_height_mm']:.3f} mm.\n"


def bars(results):
    largest = max(results, key=lambda result: result["info"]["points"])
    yield "## Targets\n"
    yield "| | target | " + " | ".join(result["recording"] for result in results) + " |"
    yield "|---|---:|" + "---:|" * len(results)
    row = lambda what, bar, each: f"| {what} | {bar} | " + " | ".join(each(result) for result in results) + " |"
    tilted = lambda result: rate(result, "tilted, handed on")
    yield row("wire bytes to tilted points, million/s", "150", lambda r: f"{tilted(r):.0f}")
    channels = lambda r: tilted(r) * r["info"]["channels"] / r["info"]["points"]
    yield row("the same, channels", "", lambda r: f"{channels(r):.0f}")
    yield row("relative to the best peer", "3", lambda r: f"{tilted(r) / best_peer(r, 'memory'):.2f}")
    in_file = lambda r: rate(r, "file, tilted") / best_peer(r, "file")
    yield row("file to points, relative to the best peer", "", lambda r: f"{in_file(r):.1f}")
    for place in largest["ply"]:
        name = {"disk": "on disk, synced", "memory": "in memory (tmpfs)"}[place]
        wall = lambda r: times(read_pcap(r)["wall_s"], r["ply"][place]["seconds"])
        yield row(f"PLY {name}: speed relative to read_pcap", "10", wall)
        cpu = lambda r: times(read_pcap(r)["seconds"], r["ply"][place]["cpu_s"])
        yield row("the same, CPU time", "", cpu)
    apart = lambda r, key: f"{r['equality'][key]:.2f}" if key in r["equality"] else "-"
    yield row("largest difference to velodyne-decoder, mm", "1", lambda r: apart(r, "max_mm"))
    yield row("the same without azimuth differences, mm", "1", lambda r: apart(r, "max_turned_mm"))
    yield ""
