"""Summary that ``maulstick plan`` prints at the end."""

from collections import Counter
from pathlib import Path

from rich.console import Console
from rich.table import Table
from rich.text import Text

from maulstick.painting.painting import Painting
from maulstick.planning.weights import STRENGTHS


def print_summary(painting: Painting, seconds: float, out: Path, written: list[str]) -> None:
    """Print the numbers of a painting, the terms of its loss, and the files written."""
    metrics = painting.provenance.metrics
    rows = {
        "strokes": f"{len(painting.strokes)}",
        "drawn": f"{painting.metres_of_paints().sum():.1f} m",
        "paints": f"{len(painting.colours())} (changes: {painting.paint_changes()})",
    }
    if len(painting.brushes) > 1:
        used = Counter(painting.paints[stroke.paint].brush for stroke in painting.strokes)
        names = ", ".join(f"{name} {used[name]}" for name in painting.brushes)
        rows["brushes"] = f"{names} strokes (changes: {painting.brush_changes()})"
    if "psnr" in metrics:
        structure = f", {metrics['ssim']:.2f} SSIM" if "ssim" in metrics else ""  # a tiny picture has none
        rows["beside the picture"] = f"{metrics['psnr']:.1f} dB PSNR{structure}"
    if "psnr_blurred" in metrics:  # lines of ink are nothing like a picture before an eye takes them together
        rows["in tones"] = f"{metrics['psnr_blurred']:.1f} dB PSNR beside those it was planned in, blurred by 2 mm"
    terms = {name: metrics[name] for name in STRENGTHS if name in metrics}
    whole = sum(terms.values()) or 1.0
    rows["loss"] = ", ".join(f"{name} {part:.5f} ({part / whole:.0%})" for name, part in terms.items())
    rows |= {"planned in": f"{seconds:.0f} s", "files": ", ".join(written)}
    table = Table(title=Text(str(out)), show_header=False)
    table.add_column()
    table.add_column(overflow="fold")
    for name, value in rows.items():
        table.add_row(name, value)
    Console().print(table)
