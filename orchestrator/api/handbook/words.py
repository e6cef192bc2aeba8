"""Equations of components beside the texts of their modules, and the words of the glossary."""

from __future__ import annotations


def _equation(text: str) -> tuple[str, ...]:
    return ("```{math}", text, "```", "")


EQUATIONS: dict[str, tuple[str, ...]] = {
    "body": (
        *_equation(
            r"\ddot\eta_j + 2 \zeta_j \omega_j \dot\eta_j + \omega_j^2 \eta_j = Q_j(t),\qquad "
            r"\dot{\mathbf p} = \textstyle\sum_k \mathbf F_k + m \mathbf g,\qquad "
            r"\dot{\mathbf L} = \textstyle\sum_k (\mathbf r_k \times \mathbf F_k + \mathbf T_k) + "
            r"\mathbf r_c \times m \mathbf g"
        ),
        "with modal coordinates $\\eta_j$, momenta $\\mathbf p$ and $\\mathbf L$ (about the world origin), wrenches",
        "$\\mathbf F_k, \\mathbf T_k$ at the ports, and the centre of mass at $\\mathbf r_c$.",
        "",
    ),
    "ccl": (
        *_equation(
            r"e = r_1 \varphi_1 - r_2 \varphi_2,\qquad "
            r"T_{a,b} = \max(0,\; P \pm k e) \text{ and the damping of taut strands}"
        ),
        "with the preload $P$ and the stiffness $k$ of one strand.",
        "",
    ),
    "contact": (
        *_equation(
            r"F = F_\mathrm{ref} \left(\frac{p}{p_\mathrm{ref}}\right)^n "
            r"+ c\, \mathrm{STEP}\!\left(\frac{p}{p_\mathrm{full}}\right) \dot p \;\ge\; 0,\qquad p > 0"
        ),
        "with the penetration $p$ and $\\mathrm{STEP}(s) = s^2 (3 - 2 s)$, 1 from $s = 1$ on.",
        "",
    ),
    "drag": (
        *_equation(
            r"F = -\tfrac12 \rho\, c_d\, b \int_{x_0}^{x_1} v(x)\, |v(x)|\, \mathrm d x,\qquad v(x) = v_0 + \omega x"
        ),
        "with the velocity $v$ along the normal of the plate of width $b$.",
        "",
    ),
    "drive": (
        *_equation(
            r"T = k\,(\varphi_c - \varphi) + c\,(\dot\varphi_c - \dot\varphi),\qquad "
            r"\varphi_c = \varphi_0 + (\varphi_1 - \varphi_0)\, s^3 (10 - 15 s + 6 s^2)"
        ),
        "for the profile `step5`, $s^2 (3 - 2 s)$ for `step`, $s$ the share of the duration that has passed.",
        "",
    ),
    "eddy_current_damper": _equation(r"T = -\frac{c\, \omega}{1 + (\omega / \omega_\mathrm{peak})^2}"),
    "hinge": (
        *_equation(
            r"T = T_\mathrm{motor}(\varphi) + T_\mathrm{harness}(\varphi) "
            r"- \left(\mu\, r_p F_r + T_\mathrm{pre}\right) \operatorname{sgn} \dot\varphi + T_\mathrm{latch}"
        ),
        "about the hinge line, with the pin's radius $r_p$ and its force $F_r$ normal to the line (Bagnoli 2007,",
        "equation 2.2); the sign of the rate is smooth, or friction sticks by an elastic deflection.",
        "",
    ),
    "point_motion": _equation(
        r"F = k\,(d_c - d) + c\,(\dot d_c - \dot d),\qquad d_c = d_0 + \mathrm{law}(t)"
    ),
    "suspension": _equation(
        r"F = \max\!\left(0,\; P + k\,(l - l_P) + c\, \dot l\right) \text{ while the spring is taut}"
    ),
}
"""Lines of Markdown by kind."""
