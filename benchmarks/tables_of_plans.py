"""Tables of plans and of the renderer, from rows that were kept."""

from collections import defaultdict

import numpy as np
from intervals import Floats, interval, mean
from kept import Row, rows_of, table, table_of, with_range

Plans = dict[str, list[Row]]  # by photograph, a row for each seed


def plans_of(rows: list[Row], image: str, name: str) -> list[Row]:
    """The plans of an image by one way, a seed each."""
    return [row for row in rows if (row["image"], row["name"]) == (image, name)]


def plan_table() -> str:
    """Photographs planned here and in the published way, over seeds; the mean of all."""
    rows = [row for row in rows_of("plan") if "seed" in row]
    lines, gains = [], []
    for image in dict.fromkeys(row["image"] for row in rows):
        plans, published = (plans_of(rows, image, name) for name in ("plan", "paper"))
        of = {(key, i): [row[key] for row in each] for i, each in enumerate((plans, published)) for key in rows[0]}
        gains.append(np.array(of["psnr", 0]) - np.array(of["psnr", 1]))
        line = [image]
        for i in (0, 1):
            line += [f"{with_range(of['psnr', i], 1)} dB", f"{np.mean(of['psnr_planned', i]):.1f} dB"]
            line += [f"{np.mean(of['ssim', i]):.2f}", f"{np.mean(of['paint_changes', i]):.0f}"]
        lines.append([*line, f"{gains[-1].mean():.1f} dB"])
    low, high = interval(gains, mean)
    head = ["photograph", "PSNR", "as planned", "SSIM", "paint changes"]
    head += ["published: PSNR", "as planned", "SSIM", "paint changes", "gain"]
    overall = f"{np.concatenate(gains).mean():.2f} ({low:.2f} to {high:.2f}) dB"
    return table(head, [*lines, ["all", *[""] * 8, overall]])


def kernel_table() -> str:
    """The renderer, forward and backward."""
    lines = []
    for row in rows_of("kernel"):
        if row["name"] != "composite":
            continue
        dense = row["dense_ms_per_stroke"]
        lines.append(
            [
                f"{row['strokes']:,}",
                f"{row['px']}²" if row["width"] == row["px"] else f"{row['width']} x {row['px']}",
                f"{row['half_width_px']:.2f} px",
                f"{row['ms_forward']:.1f} + {row['ms_backward']:.1f} ms",
                "not timed" if dense is None else f"{dense:.0f} ms",
                "" if dense is None else f"{row['speedup']:,.0f}",
                f"{row['extra_mib']:.0f} MiB",
            ]
        )
    return table(
        ["strokes", "canvas", "half-width", "forward + backward", "dense, one stroke", "times faster", "extra memory"],
        lines,
    )


def likeness_table() -> str:
    """What a network brings, and costs, beside tones alone."""
    rows = [row for row in rows_of("plan") if "seed" in row]
    lines = []
    for image in dict.fromkeys(row["image"] for row in rows):
        tones, likeness = (plans_of(rows, image, name) for name in ("plan", "likeness"))
        line = [image]
        for key, digits, unit in (("psnr", 1, " dB"), ("ssim", 2, "")):
            before, after = (np.array([row[key] for row in each]) for each in (tones, likeness))
            line += [with_range(each.tolist(), digits) + unit for each in (before, after)]
            line.append(f"{(after - before).mean():+.{digits + 1}f}{unit}")
        lines.append(line)
    head = ["PSNR: tones", "with likeness", "more", "SSIM: tones", "with likeness", "more"]
    return table(["photograph", *head], lines)


def other_renderer_table() -> str:
    """Ours and splender, forward and backward."""
    lines = []
    for row in rows_of("other_renderer"):
        line = [f"{row['strokes']}", f"{row['px']}²", f"{row['half_width_px']:.2f} px"]
        line += [f"{row['ms_ours']:.2f} ms", f"{row['ms_splender']:,.1f} ms"]
        line += [f"{row['ms_splender'] / row['ms_ours']:.0f}", f"{row['compile_s']:.0f} s"]
        lines.append(line + [f"{row[f'mean_{name}']:.4f}, {row[f'worst_{name}']:.2f}" for name in ("ours", "splender")])
    head = ["strokes", "canvas", "half-width", "ours", "splender", "times faster", "splender compiles"]
    return table([*head, "off its truth (mean, worst): ours", "splender"], lines)


def scaling_table() -> str:
    """What a step costs."""
    columns = {
        "strokes": "{strokes:,}",
        "pixels high": "{px}",
        "covered": "{covered_mpx:.2f} Mpx",
        "per step": "{step_ms:.0f} ms",
        "per pixel, covered or of the canvas": "{ns_a_pixel:.0f} ns",
    }
    return table_of(rows_of("scaling"), columns)


def large_table() -> str:
    """How well and how fast many strokes are planned on large canvases."""
    columns = {
        "strokes": "{strokes:,}",
        "pixels high": "{px:,}",
        "seconds": "{seconds:.0f}",
        "of the processor": "{processor_seconds:.0f}",
        "memory": "{peak_mib:,} MiB",
        "PSNR": "{psnr:.1f} dB",
        "on the planner's pixels": "{psnr_planned:.1f} dB",
    }
    return table_of(rows_of("large"), columns)


def clip_size_table() -> str:
    """How long a plan takes with a network of CLIP's size."""
    columns = {
        "network": "{model}",
        "parameters": "{parameters} million",
        "steps between evaluations": "{ask_every}",
        "per step": "{step_ms:,.0f} ms",
        "2,000 steps would take": "{minutes:.1f} minutes",
    }
    return table_of(rows_of("clip_size"), columns)


def startup_table() -> str:
    """What a plan takes beside its steps, in seconds and in those that PyTorch takes to load."""
    rows = {(row["case"], row["stage"]): row for row in rows_of("startup")}
    cases, stages = (list(dict.fromkeys(key[i] for key in rows)) for i in (0, 1))
    lines = []
    for stage in stages:
        line = [stage]
        for case in cases:
            line += [f"{rows[case, stage]['seconds']:.2f} s", f"{rows[case, stage]['torch']:.2f}"]
        lines.append(line)
    return table(["stage", *(title for case in cases for title in (case, "times `import torch`"))], lines)


def step_cost_table() -> str:
    """What a step costs beside its kernels."""
    columns = {
        "style": "{style}",
        "version": "{source}",
        "middle step": "{step_ms:.1f} ms",
        "renderer": "{kernel_ms:.1f} ms",
        "ratio": "{ratio:.2f}",
        "mean of all steps": "{mean_ms:.1f} ms",
    }
    return table_of(rows_of("step_cost"), columns)


def several_brushes_table() -> str:
    """How near plans of one and of several brushes come to photographs, and how much several gain."""
    rows = rows_of("several_brushes")
    images = list(dict.fromkeys(row["image"] for row in rows))
    lines = []
    for style, names in dict.fromkeys((row["style"], row["brushes"]) for row in rows):
        found = [
            [row for row in rows if (row["style"], row["brushes"], row["image"]) == (style, names, i)] for i in images
        ]
        gains = [np.array([row["gain"] for row in each if "gain" in row]) for each in found]
        line = [style, f"`{names}`"]
        for each, more in zip(found, gains, strict=True):
            psnr = f"{np.mean([row['psnr'] for row in each]):.2f}"
            line.append(psnr if not len(more) else f"{psnr} ({np.mean(more):+.2f})")
        if all(map(len, gains)):
            line.append(gain_of(gains))
        else:
            line.append("")
        lines.append(line)
    return table(["style", "brushes", *images, "gain"], lines)


def steps_table() -> str:
    """How good plans of fewer steps are beside those of before."""
    found, lines = steps_of(rows_of("steps")), []
    for (style, source, steps), plans in found.items():
        before = next(each for (other, name, _), each in found.items() if (other, name) == (style, "before"))
        more = more_than(plans, before)
        means = _means(plans, {"psnr": "{:.2f} dB", "ssim": "{:.3f}", "seconds": "{:.0f} s"})
        line = [style, source, f"{steps:,}", *means]
        lines.append([*line, *(["", ""] if source == "before" else [gain_of(more), f"{min(map(mean, more)):+.2f} dB"])])
    return table(["style", "version", "steps", "PSNR", "SSIM", "processor", "more than before", "worst"], lines)


def steps_of(rows: list[Row]) -> dict[tuple[str, str, int], Plans]:
    """Plans by style, version and number of steps."""
    found: dict[tuple[str, str, int], Plans] = defaultdict(lambda: defaultdict(list))
    for row in rows:
        found[row["style"], row["source"], row["steps"]][row["image"]].append(row)
    return found


def known_start_table() -> str:
    """What plans gain by starts that are known."""
    found: dict[str, Plans] = defaultdict(lambda: defaultdict(list))
    for row in rows_of("known_start"):
        found[row["start"]][row["image"]].append(row)
    lines = []
    for start, plans in found.items():
        means = _means(plans, {"psnr": "{:.2f} dB", "ssim": "{:.3f}"})
        lines.append([start, *means, "" if start == "usual" else gain_of(more_than(plans, found["usual"]))])
    return table(["start", "PSNR", "SSIM", "more than usual"], lines)


def _means(plans: Plans, written: dict[str, str]) -> list[str]:
    """Means of figures over all plans, each as it is written."""
    rows = [row for each in plans.values() for row in each]
    return [form.format(np.mean([row[key] for row in rows])) for key, form in written.items()]


def more_than(plans: Plans, others: Plans) -> list[Floats]:
    """How much more PSNR plans have than others of the same photographs and seeds, by photograph."""
    pairs = [zip(rows, others[image], strict=True) for image, rows in plans.items()]
    return [np.array([row["psnr"] - other["psnr"] for row, other in each]) for each in pairs]


def gain_of(more: list[Floats]) -> str:
    """Their mean, with a 95 % interval by bootstrap over photographs."""
    low, high = interval(more, mean)
    return f"{mean(np.concatenate(more)):+.2f} ({low:+.2f} to {high:+.2f}) dB"
