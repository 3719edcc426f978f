"""Learn a hand, fit a brush, plan a painting, and let a machine paint it.

    import maulstick as ms

    painting = ms.plan("cat.jpg", style="loops", brush="marker", strokes=600)
    painting.save("cat.json")
    ms.render(painting, px=1024).save("cat.png")
    ms.paint(painting, robot="sim")

Names are loaded when they are first used, so that importing the package takes a moment only.
"""

from importlib.metadata import version

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__version__ = version("maulstick")
__all__ += ["__version__"]
