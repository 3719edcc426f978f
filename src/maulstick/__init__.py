"""Learn a hand, fit a brush, plan a painting, and let a machine paint it.

    import maulstick as ms

    painting = ms.plan("cat.jpg", style="loops", brush="marker", strokes=600)
    painting.save("cat.json")
    ms.render(painting, px=1024).save("cat.png")
    ms.paint(painting, robot="sim")

Names are loaded when they are first used, so that importing the package takes a moment only.
"""

from typing import Any

import lazy_loader

_load, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__all__ += ["__version__"]


def __getattr__(name: str) -> Any:
    """Return what the package has under this name, loading it. Raises InputError where that needs PyTorch in vain."""
    if name == "__version__":
        from importlib.metadata import version  # takes a tenth of the command line's start

        return version("maulstick")
    from maulstick.api.usual_torch import usual_torch  # else tensors that modules keep would be of the caller's kind
    from maulstick.errors import needs_torch

    with needs_torch(), usual_torch():
        return _load(name)
