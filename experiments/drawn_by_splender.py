"""One scene by splender, for `other_renderer.py`, in an environment of its own.

    build/splender/bin/python experiments/drawn_by_splender.py SCENE.npz OUT.npz

splender 0.1.0 (MIT; Zdyb et al. 2025) stamps a fuzzy brush at 100 places along each spline, adds the stamps up, keeps
the darkest stroke at each pixel, and bends the sum into a grey between 0 and 1 by contrast, brightness and a sigmoid.
"""

import os
import sys
import time

os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"

import jax
import jax.numpy as jnp
import numpy as np
from jax.scipy.special import logit
from splender.image import SplenderImage

WIDE = 5.0
"""Before the sigmoid: the share of its scale that a stroke has at a knot, as splender begins."""
BLANK = 4.0
"""Before the sigmoid: blank paper is 0.02 dark, and the middle of a stroke 0.98."""


def main() -> None:
    """Draw the scene and lead a gradient back, several times; and draw it on finer pixels."""
    with np.load(sys.argv[1]) as scene:
        px, half_width, finer, runs = (scene[key].item() for key in ("px", "half_width", "finer", "runs"))
        places, length = jnp.asarray(scene["knots"]), scene["length"].item()
        weights = jnp.asarray(scene["weights"])

    def model_on(pixels: int) -> tuple[SplenderImage, jax.Array, jax.Array]:
        """The model on so many pixels, its parameters at the knots, and the scale of each stroke's brush there."""
        model = SplenderImage(key=jax.random.key(0), init_knots=places[None], res=pixels)
        stamp = model.brush_model()
        middle = model.n_points_per_spline_per_frame / length * 2 * half_width * stamp[stamp.shape[0] // 2].mean()
        model.contrast, model.brightness = 2 * BLANK / middle[None], jnp.full(1, -BLANK)
        scale = 2 * half_width * pixels / stamp.shape[0] / jax.nn.sigmoid(WIDE)
        from_centre = places - 0.5 / pixels  # to it, 0 is the centre of the first pixel
        knots = jnp.concatenate([logit(from_centre), jnp.full((*places.shape[:2], 1), WIDE)], axis=-1)
        return model, knots, jnp.full(len(places), scale)

    model, knots, scales = model_on(px)

    def loss(knots: jax.Array, scales: jax.Array) -> tuple[jax.Array, jax.Array]:
        picture, *_ = model.render_image(knots, scales)
        return (weights * picture).sum(), picture

    start = time.perf_counter()
    both_ways = jax.jit(jax.value_and_grad(loss, argnums=(0, 1), has_aux=True)).lower(knots, scales).compile()
    compile_s = time.perf_counter() - start
    (_, picture), gradients = jax.block_until_ready(both_ways(knots, scales))
    assert all(bool(jnp.isfinite(gradient).all()) for gradient in gradients)
    ms = []
    for _ in range(runs):
        start = time.process_time()
        jax.block_until_ready(both_ways(knots, scales))
        ms.append(1e3 * (time.process_time() - start))

    fine, knots, scales = model_on(finer * px)
    draw = jax.jit(lambda knots, scales: fine.render_splines(knots, scales)[0])
    darkest = jnp.zeros((finer * px, finer * px))
    for stroke in range(len(knots)):  # all at once would take 10 GB; opacity 1 keeps the darkest
        darkest = jnp.maximum(darkest, draw(knots[stroke : stroke + 1], scales[stroke : stroke + 1]))
    truth = jax.nn.sigmoid(darkest * fine.contrast + fine.brightness)
    truth = truth.reshape(px, finer, px, finer).mean(axis=(1, 3))
    np.savez(sys.argv[2], ms=ms, compile_s=compile_s, picture=picture, truth=truth)


if __name__ == "__main__":
    main()
