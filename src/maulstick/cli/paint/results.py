"""What ``maulstick paint`` leaves behind: files, all together or none, and a table."""

import io
from pathlib import Path

from rich.console import Console
from rich.table import Table
from rich.text import Text

from maulstick.brush.preview import preview
from maulstick.canvas import Canvas
from maulstick.cli.folder import all_or_nothing
from maulstick.files import atomic_write
from maulstick.film import FORMATS, Film
from maulstick.painting import Painting, write_painting
from maulstick.palette import swatches
from maulstick.picture import encode_png
from maulstick.plan.terms import STRENGTHS
from maulstick.svg import painting_svg

_PREVIEW_PX, _WIDEST_PX = 1024, 4096


def write_results(painting: Painting, out: Path, film: Film | None) -> list[str]:
    """Write all files; their names. A film of an earlier plan goes, since it would not be of this one."""
    with all_or_nothing(out) as folder:
        write_painting(painting, folder / "painting.json")
        atomic_write(folder / "painting.svg", painting_svg(painting).encode())
        atomic_write(folder / "preview.png", _preview(painting))
        atomic_write(folder / "palette.png", _palette(painting))
        if film is not None:
            atomic_write(folder / f"progress.{film.kind}", film.encode())
        names = sorted(path.name for path in folder.iterdir())
    for kind in FORMATS:
        if (older := f"progress.{kind}") not in names:
            (out / older).unlink(missing_ok=True)
    return names


def _preview(painting: Painting) -> bytes:
    width, height = painting.canvas.width, painting.canvas.height
    return encode_png(preview(painting, Canvas(width, height, min(_PREVIEW_PX / height, _WIDEST_PX / width))))


def _palette(painting: Painting) -> bytes:
    metres = painting.metres_of_paints()
    labels = [f"{i + 1}   {paint.label}   {metres[i]:.2f} m" for i, paint in enumerate(painting.paints)]
    file = io.BytesIO()
    swatches([paint.colour for paint in painting.paints], labels).save(file, format="PNG")
    return file.getvalue()


def print_summary(painting: Painting, seconds: float, out: Path, written: list[str]) -> None:
    """What was planned, what each term of the loss comes to in the end, and where it is."""
    figures = painting.made.figures
    rows = {
        "strokes": f"{len(painting.strokes)}",
        "drawn": f"{painting.metres_of_paints().sum():.1f} m",
        "paints": f"{len(painting.paints)} (changes: {painting.paint_changes()})",
    }
    if "psnr" in figures:
        structure = f", {figures['ssim']:.2f} SSIM" if "ssim" in figures else ""  # a tiny picture has none
        rows["beside the picture"] = f"{figures['psnr']:.1f} dB PSNR{structure}"
    terms = {name: figures[name] for name in STRENGTHS if name in figures}
    whole = sum(terms.values()) or 1.0
    rows["loss"] = ", ".join(f"{name} {part:.5f} ({part / whole:.0%})" for name, part in terms.items())
    rows |= {"planned in": f"{seconds:.0f} s", "files": ", ".join(written)}
    table = Table(title=Text(str(out)), show_header=False)
    table.add_column()
    table.add_column(overflow="fold")
    for name, value in rows.items():
        table.add_row(name, value)
    Console().print(table)
