"""Equations above the texts of their modules, and what those texts cite."""

from __future__ import annotations

_BODY = (
    r"\ddot{\eta}{}_j + 2 \zeta_j \omega_j \dot{\eta}{}_j + \omega_j^2 \eta_j = Q_j(t),\qquad "
    r"\mathbf r = \mathbf r_c + \mathbf R\,(\mathbf X + \boldsymbol\Phi\, \boldsymbol\eta)",
    r"\dot{\mathbf p} = \sum_k \mathbf F_k + m \mathbf g,\qquad "
    r"\dot{\mathbf L} = \sum_k (\mathbf r_k \times \mathbf F_k + \mathbf T_k) + \mathbf r_c \times m \mathbf g",
)

EQUATIONS: dict[str, tuple[tuple[str, ...], str]] = {
    "beam": (
        (
            r"U = \frac{L}{2}\, \mathbf e^T \mathbf C\, \mathbf e,\qquad \mathbf e = (\boldsymbol\gamma - "
            r"\boldsymbol\gamma_0,\; \boldsymbol\kappa - \boldsymbol\kappa_0),\qquad \boldsymbol\gamma = \mathbf R^T "
            r"\mathbf x',\quad \boldsymbol\kappa = \operatorname{axial}\left(\mathbf R^T \mathbf R'\right)",
        ),
        r"of an element of the length $L$ with stretch and shear $\boldsymbol\gamma$, twist and bending "
        r"$\boldsymbol\kappa$, and the stiffness $\mathbf C$ of its section.",
    ),
    "body": (
        _BODY,
        r"with modal coordinates $\eta_j$, their forces $Q_j$ from loads and from rates of the frame, momenta "
        r"$\mathbf p$ and $\mathbf L$ (about the world origin), wrenches $\mathbf F_k, \mathbf T_k$ at the ports, and "
        r"the centre of mass at $\mathbf r_c$.",
    ),
    "ccl": (
        (
            r"e_{a,b} = \Delta \ell \pm (r_1\, \Delta\varphi_1 - r_2\, \Delta\varphi_2)",
            r"T_{a,b} = \max(0,\; P + k\, e_{a,b} + c\, \dot e{}_{a,b}) \text{ where the strand is taut}",
        ),
        r"with the preload $P$, the stiffness $k$ and the damping $c$ of one strand, the radii $r_i$, the angles "
        r"$\varphi_i$ of the pulleys against the strands, and the length $\ell$ of these.",
    ),
    "contact": (
        (
            r"F = F_\mathrm{ref} \left(\frac{p}{p_\mathrm{ref}}\right)^n + c\, "
            r"\mathrm{STEP}\!\left(\frac{p}{p_\mathrm{full}}\right) \dot p \;\ge\; 0,\qquad p > 0",
        ),
        r"with the penetration $p$ and $\mathrm{STEP}(s) = s^2 (3 - 2 s)$, 1 from $s = 1$ on.",
    ),
    "drag": (
        (
            r"F = -\frac{1}{2}\, \rho\, c_d\, b \int_{x_0}^{x_1} v(x)\, |v(x)|\, \mathrm d x,\qquad "
            r"v(x) = v_0 - \omega x",
        ),
        r"with the velocity $v$ along the normal of the plate of width $b$, which turns at the rate $\omega$ about y.",
    ),
    "drive": (
        (
            r"T = k\,(\varphi_c - \varphi) + c\,(\dot{\varphi}{}_c - \dot\varphi),\qquad "
            r"\varphi_c = \varphi_0 + (\varphi_1 - \varphi_0)\, s^3 (10 - 15 s + 6 s^2)",
        ),
        r"for the profile `step5`, $s^2 (3 - 2 s)$ for `step`, $s$ the share of the duration $\tau$ that has passed; "
        r"for `commanded` $\tau\, \dot{\varphi}{}_c = \varphi_1 - \varphi_c$.",
    ),
    "eddy_current_damper": (
        (r"T = -\frac{c\, \omega}{1 + (\omega / \omega_\mathrm{peak})^2}",),
        r"at the rate $\omega$, largest at $\omega_\mathrm{peak}$; without a peak rate it is linear.",
    ),
    "driven_base": (
        (
            r"\mathbf v(t) = \mathbf v_0 + \mathbf a_0\, t + \tfrac{1}{2}\, \mathbf j\, t^2,\qquad "
            r"\boldsymbol\varphi(t) = \boldsymbol\omega_0\, t + \tfrac{1}{2}\, \boldsymbol\alpha_0\, t^2 + "
            r"\tfrac{1}{6}\, \mathbf k\, t^3 + \left(\tfrac{1}{12}\, t^3\, \boldsymbol\alpha_0 + "
            r"\tfrac{1}{24}\, t^4\, \mathbf k\right) \times \boldsymbol\omega_0",
        ),
        r"over a step, with the velocity and the rotation vector of the frame, whose accelerations change at the rates "
        r"$\mathbf j$ and $\mathbf k$ that the inputs hold.",
    ),
    "end_stop": (
        (
            r"T = -\max\left(0,\; k\, p + c\, \mathrm{STEP}\!\left(\frac{p}{p_\mathrm{full}}\right) "
            r"\dot p\right),\qquad p = \varphi - \varphi_\mathrm{stop} > 0",
        ),
        r"with the penetration $p$ of the hinge angle $\varphi$; $\mathrm{STEP}$ is that of a contact.",
    ),
    "fixed_base": (
        (
            r"\mathbf F = \sum_k \mathbf F_k,\qquad "
            r"\mathbf T = \sum_k \left(\mathbf T_k + (\mathbf r_k - \mathbf r_0) \times \mathbf F_k\right)",
        ),
        r"are the interface loads of the wrenches $\mathbf F_k, \mathbf T_k$ at its ports, about the reference "
        r"$\mathbf r_0$.",
    ),
    "hinge": (
        (
            r"T = T_\mathrm{motor}(\varphi) + T_\mathrm{harness}(\varphi) - \left(\mu\, r_p F_r + "
            r"T_\mathrm{pre}\right) \operatorname{sgn} \dot\varphi - T_\mathrm{latch}",
            r"T_\mathrm{latch} = k_l (\varphi - \varphi_l) + c_l \dot\varphi,\qquad F_i = -k_i q_i - c_i \dot q{}_i",
        ),
        r"about the hinge line and, with $F_i$, along and about all axes, with the pin's radius $r_p$ and its force "
        r"$F_r$ normal to the line (Bagnoli 2007, equation 2.2). The latch torque begins with the latch-up. Below "
        r"its largest torque friction sticks, by an elastic deflection; with the smooth law it falls with the rate.",
    ),
    "hold_down": (
        (r"F_i = -k_i\, q_i - c_i\, \dot q{}_i - P a_i,\qquad i = x, y, z",),
        r"on the outboard port in axes of the inboard one, with displacements $q$ from the start, the preload $P$ "
        r"along the axis $\mathbf a$; nothing from the release on.",
    ),
    "load": (
        (
            r"\mathbf F = \left(f(t) + f_+\right) \mathbf d,\qquad \mathbf T = \left(\tau(t) + \tau_+\right) \mathbf d",
        ),
        r"along the direction $\mathbf d$ with the laws $f$ and $\tau$ and what is added in mid-run.",
    ),
    "moving_base": (
        (
            r"\mathbf r_k = \mathbf r_P + s(t)\, \mathbf a + \mathbf R(\theta(t)\, \mathbf b)\, \mathbf R_0\, "
            r"(\mathbf x_k - \mathbf x_P)",
        ),
        r"with the laws $s$ of the shift along $\mathbf a$ and $\theta$ of the turn about $\mathbf b$, the pivot $P$ "
        r"and the orientation $\mathbf R_0$ where both are zero.",
    ),
    "point_motion": (
        (r"F = k\,(d_c - d) + c\,(\dot d{}_c - \dot d),\qquad d_c = d_0 + \mathrm{law}(t)",),
        r"with the distance $d$ of the ports along the axis.",
    ),
    "rail": (
        (
            r"F_n = -k_n q_n - c_n \dot q{}_n,\qquad T_i = -k_r \theta_i - c_r \dot{\theta}{}_i,\qquad "
            r"\mathbf F_t = -F_\mu\, \frac{\mathbf v}{|\mathbf v|}",
        ),
        r"with the displacement $q_n$ normal to the plane, rotations $\theta_i$, and friction $F_\mu$ against the "
        r"sliding velocity $\mathbf v$. Below $F_\mu$ the trolley sticks, by an elastic deflection.",
    ),
    "suspension": (
        (r"F = \max\!\left(0,\; P + k\,(l - l_P) + c\, \dot l\right) \text{ while the spring is taut}",),
        r"with the distance $l$ of the ports, $l_P$ at the preload $P$.",
    ),
    "components.flexible.reduction": (
        (
            r"\mathbf u = \boldsymbol\Phi\, \mathbf q + \boldsymbol\Psi\, \mathbf u_a,\qquad "
            r"\mathbf K_{ii} \boldsymbol\Phi = \mathbf M_{ii} \boldsymbol\Phi\, \boldsymbol\Omega^2,\qquad "
            r"\boldsymbol\Psi = -\mathbf K_{ii}^{-1} \mathbf K_{ia}",
        ),
        r"with the degrees of freedom $\mathbf u_a$ of attachment points and $\mathbf u_i$ of the rest.",
    ),
    "orchestrator.cosim.implicit.solver": (
        (
            r"\mathbf r(\mathbf w) = \mathbf C\!\left(\mathbf B(\mathbf w)\right) - \mathbf w = 0,\qquad "
            r"(\mathbf I - \mathbf S\, \mathbf Y)\, \Delta\mathbf w = \mathbf r",
        ),
        r"with the motions $\mathbf B$ that bodies give for the wrenches $\mathbf w$, the wrenches $\mathbf C$ that "
        r"connections return for motions, and their derivatives $\mathbf Y$, mobility, and $\mathbf S$, stiffness.",
    ),
}
"""LaTeX and what its letters mean, by kind of component or by module."""

SOURCES = {
    "Bock 1981": "H. G. Bock, Numerical treatment of inverse problems in chemical reaction kinetics, in Modelling of "
    "Chemical Reaction Systems. Springer, 1981",
    "Allen 1969": "H. G. Allen, Analysis and Design of Structural Sandwich Panels. Pergamon, 1969",
    "Bagnoli 2007": "S. Bagnoli, thesis, 2007, on the deployment of the wings that the scenes have",
    "Craig and Bampton 1968": "R. R. Craig and M. C. C. Bampton, Coupling of Substructures for Dynamic Analyses. AIAA "
    "Journal 6 (1968), 1313-1319",
    "Cowper 1966": "G. R. Cowper, The Shear Coefficient in Timoshenko's Beam Theory. Journal of Applied Mechanics 33 "
    "(1966), 335-340",
    "Duff, Grimes and Lewis 1992": "I. S. Duff, R. G. Grimes and J. G. Lewis, User's Guide for the Harwell-Boeing "
    "Sparse Matrix Collection. 1992",
    "Dupont, Hayward, Armstrong and Altpeter 2002": "P. Dupont, V. Hayward, B. Armstrong and F. Altpeter, Single State "
    "Elastoplastic Friction Models. IEEE Transactions on Automatic Control 47 (2002), 787-792",
    "ECSS-E-ST-33-01C": "European Cooperation for Space Standardization, Mechanisms, 2009",
    "Imbert, Mamode 1978": "J. F. Imbert and A. Mamode, La masse effective. 1978",
    "Jones 1999": "R. M. Jones, Mechanics of Composite Materials, second edition. Taylor and Francis, 1999",
    "Likins 1970": "P. W. Likins, Dynamics and Control of Flexible Space Vehicles. JPL Technical Report 32-1329, 1970",
    "Muravyov and Rizzi 2003": "A. A. Muravyov and S. A. Rizzi, Determination of Nonlinear Stiffness with Application "
    "to Random Vibration of Geometrically Nonlinear Structures. Computers and Structures 81 (2003), 1513-1523",
    "Simo and Wong 1991": "J. C. Simo and K. K. Wong, Unconditionally Stable Algorithms for Rigid Body Dynamics that "
    "Exactly Preserve Energy and Momentum. International Journal for Numerical Methods in Engineering 31 (1991), 19-52",
    "Timoshenko and Woinowsky-Krieger": "S. Timoshenko and S. Woinowsky-Krieger, Theory of Plates and Shells, second "
    "edition. McGraw-Hill, 1959",
    "Wu and Tiso 2016": "L. Wu and P. Tiso, Nonlinear Model Order Reduction for Flexible Multibody Dynamics: a Modal "
    "Derivatives Approach. Multibody System Dynamics 36 (2016), 405-425",
}
"""By how the texts name them."""
