"""Visual contrastive decoding: the second row sees the report with a noised diagram.

    y_t ~ softmax[(1 + alpha) logit(y | v, x) - alpha logit(y | v', x)],  p(y | v, x) >= beta max p
    v' = sqrt(a_T) v + sqrt(1 - a_T) e,  e ~ N(0, 1),  a_T = prod_{t<=T} (1 - b_t)

Leng et al. 2024, "Mitigating Object Hallucinations in Large Vision-Language Models through Visual
Contrastive Decoding", arXiv:2311.16922, eq. 2-4; b_t is the authors' sigmoid schedule of 1,000 steps.
Only the diagram is amplified: the narrative stands in both rows.
"""

from __future__ import annotations

import hashlib
import io

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from pydantic import Field

from plugins.decoder.base import FixedContrast
from sgcad_core.case.records import Context, Diagram
from sgcad_core.system.pictures import opened


class Vcd(FixedContrast):
    """Amplifies what the diagrams show over what the narrative alone makes likely.

    alpha is the strength of the contrast; 0 is greedy or sampled decoding of the row with context.
    """

    alpha: float = Field(1.0, ge=0.0, le=10.0)
    beta: float = Field(0.1, ge=0.0, lt=1.0, description="plausibility: p >= beta * max p with context; 0 = off")
    noise_step: int = Field(500, ge=1, le=1000, description="step T of 1,000: 1 hardly any noise, 1,000 noise alone")

    def contrast_context(self, context: Context) -> Context | None:
        """The same report, its diagrams noised; the noise follows from the picture, so it can be repeated."""
        noised = tuple(_noised(diagram, self.noise_step) for diagram in context.diagrams)
        return context.model_copy(update={"diagrams": noised})


def kept_signal(step: int) -> float:
    """a_T: the share of the picture's variance that is left after `step` of 1,000 diffusion steps."""
    sigmoid = 1.0 / (1.0 + np.exp(-np.linspace(-6.0, 6.0, 1000)))
    betas = sigmoid * (0.5e-2 - 1e-5) + 1e-5
    return float(np.prod(1.0 - betas[:step]))


def _noised(diagram: Diagram, step: int) -> Diagram:
    seed = int.from_bytes(hashlib.sha256(diagram.png).digest()[:8], "big")
    with opened(diagram.png) as picture:
        pixels = np.asarray(picture.convert("RGB"), dtype=np.float64) / 127.5 - 1.0
    kept = kept_signal(step)
    noise = np.random.default_rng(seed).standard_normal(pixels.shape)
    return _diagram(np.sqrt(kept) * pixels + np.sqrt(1.0 - kept) * noise)


def _diagram(pixels: NDArray[np.float64]) -> Diagram:
    """Pixels (height, width, 3) in -1..1, clipped, as a diagram."""
    picture = Image.fromarray(((pixels.clip(-1.0, 1.0) + 1.0) * 127.5).round().astype(np.uint8))
    out = io.BytesIO()
    picture.save(out, format="PNG")
    return Diagram(png=out.getvalue(), width_px=picture.width, height_px=picture.height)
