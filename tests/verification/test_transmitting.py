"""Transmitting faces: traction -rho c_d v_n - rho c_s v_t (Lysmer and Kuhlemeyer 1969, a = b = 1).

Elastic packets of tiny amplitude, so that nothing but the boundary and the discretisation is at work.
"""

import numpy as np
import pytest
from builders import (
    FREE,
    PRECISIONS,
    SYMMETRY,
    TRANSMITTING,
    by_id,
    elastic,
    lattice,
    options,
    set_by_id,
    solver,
)

NU, RHO, CD = 0.33, 1000.0, 1000.0
LAMBDA_2G = RHO * CD**2
G = LAMBDA_2G * (1 - 2 * NU) / (2 * (1 - NU))
K = LAMBDA_2G - 4 / 3 * G
CS = np.sqrt(G / RHO)
YOUNG = 9 * K * G / (3 * K + G)
TINY = 1e-6  # of c_d: terms of second order are then 1e-6 of the first
H = 1.0


def material():
    return elastic(YOUNG, NU, RHO)


def reflection(theta, kind="P"):
    """Reflected P and SV displacement amplitudes of a plane wave that meets the face x = 0 from x < 0 at `theta`.

    Solves t = sigma . e_x = -rho (c_d v_x, c_s v_y) for unit incident displacement.
    """
    slow = np.sin(theta) / (CD if kind == "P" else CS)  # along the face, kept by all waves

    def wave(c, sign, shear):
        ny = slow * c
        nx = sign * np.emath.sqrt(1 - ny**2)
        d = np.array([-ny, nx]) if shear else np.array([nx, ny])
        # u = d exp(i w (n.x/c - t)), in units of i w.
        grad = np.outer(d, [nx, ny]) / c
        strain = (grad + grad.T) / 2
        stress = (K - 2 / 3 * G) * np.trace(strain) * np.eye(2) + 2 * G * strain
        velocity = -d
        return stress[:, 0] + RHO * np.array([CD, CS]) * velocity

    incident = wave(CD, 1, False) if kind == "P" else wave(CS, 1, True)
    return np.linalg.solve(np.column_stack([wave(CD, -1, False), wave(CS, -1, True)]), -incident)


def reflected_energy(theta, kind="P"):
    """Fractions of the incident energy that go back as P and as SV (flux normal to the face)."""
    p, s = np.abs(reflection(theta, kind)) ** 2
    slow = np.sin(theta) / (CD if kind == "P" else CS)
    flux = {"P": CD * np.sqrt(1 - min(slow * CD, 1) ** 2), "S": CS * np.sqrt(1 - (slow * CS) ** 2)}
    own = flux["P" if kind == "P" else "S"]
    return p * flux["P"] / own, s * flux["S"] / own


def test_the_theory_is_the_one_of_the_table():
    """Computed from the theory beforehand: |R_pp| and the reflected energy of P."""
    angles = np.radians([0, 15, 30, 45, 60, 75])
    amplitude = [abs(reflection(a)[0]) for a in angles]
    energy = [sum(reflected_energy(a)) for a in angles]
    print("|R_pp|", np.round(amplitude, 4), "energy", np.round(energy, 4))
    np.testing.assert_allclose(amplitude, [0, 0.0005, 0.0122, 0.0629, 0.1936, 0.4644], atol=1e-4)
    np.testing.assert_allclose(energy, [0, 0.0000, 0.0006, 0.0078, 0.0499, 0.2348], atol=1e-4)


def strain_energy(s, volume):
    p, d = by_id(s, "pressure"), by_id(s, "deviator")
    dd = (d[:, :3] ** 2).sum(1) + 2 * (d[:, 3:] ** 2).sum(1)
    return (p**2 / (2 * K) + dd / (4 * G)).sum() * volume


def set_strain(s, strain, volume):
    """The stress, volume and energy of a small strain (n, 6: xx yy zz xy yz zx)."""
    trace = strain[:, :3].sum(1)
    d = 2 * G * strain
    d[:, :3] -= 2 * G * trace[:, None] / 3
    set_by_id(s, "pressure", -K * trace)
    set_by_id(s, "deviator", d)
    set_by_id(s, "volume", volume / (1 - trace))  # p = K (V0/V - 1)
    dd = (d[:, :3] ** 2).sum(1) + 2 * (d[:, 3:] ** 2).sum(1)
    set_by_id(s, "energy", K * trace**2 / 2 + dd / (4 * G))


@pytest.mark.parametrize(
    ("scheme", "shape"),
    [("usf", "trilinear"), ("musl", "trilinear"), ("usavg", "trilinear"), ("usavg", "quadratic")],
)
@PRECISIONS
def test_normal_incidence(scheme, shape, single):
    """A P pulse of standard width 8 cells runs into the face: less than 1 % of its energy comes back."""
    n, width, start = 160, 8 * H, 80 * H
    position = lattice((0, 0, 0), (2 * n, 1, 1), (H / 2, H, H))
    volume = H**3 / 2
    tiny = 1e-4 if single else TINY  # a volume of 1 - 1e-6 is known to 6 % in single precision
    pulse = tiny * np.exp(-(((position[:, 0] - start) / width) ** 2) / 2)
    v = np.zeros((2 * n, 3))
    v[:, 0] = CD * pulse
    s = solver(
        (0, 0, 0),
        H,
        (n, 1, 1),
        [FREE, TRANSMITTING] + [SYMMETRY] * 4,
        [material()],
        options(scheme, shape),
        [(position, v, volume, RHO, 0)],
        single=single,
    )
    strain = np.zeros((2 * n, 6))
    strain[:, 0] = -pulse
    set_strain(s, strain, volume)
    before = s.ledger()["kinetic"] + strain_energy(s, volume)
    s.advance(10**6, (160 - 10) * H / CD)  # there and 70 cells back
    after = s.ledger()["kinetic"] + strain_energy(s, volume)
    print(f"{scheme} {shape}: reflected energy {after / before:.2e}")
    assert after / before < 0.01
    # The ledger says where it went.
    assert s.ledger()["absorbed"] / before == pytest.approx(1, abs=0.01)


# ---- oblique packets -----------------------------------------------------------------------------


def packet(kind, theta, wavelength, long, wide, cells, centre):
    """Velocity and strain on the lattice of 2 x 2 points a cell of a pure P or SV packet, and its spectrum.

    Built in Fourier space, so that every plane wave in it has the right polarisation.
    """
    nx, ny = 2 * cells[0], 2 * cells[1]
    kx, ky = np.meshgrid(
        2 * np.pi * np.fft.fftfreq(nx, H / 2), 2 * np.pi * np.fft.fftfreq(ny, H / 2), indexing="ij"
    )
    k = np.hypot(kx, ky)
    k[0, 0] = 1
    along = kx * np.cos(theta) + ky * np.sin(theta)
    across = -kx * np.sin(theta) + ky * np.cos(theta)
    a = np.exp(-((along - 2 * np.pi / wavelength) ** 2) * long**2 / 2 - across**2 * wide**2 / 2)
    a[0, 0] = 0
    ex, ey = kx / k, ky / k
    c = CD if kind == "P" else CS
    d = (ex, ey) if kind == "P" else (-ey, ex)
    phase = np.exp(-1j * (kx * (centre[0] - H / 4) + ky * (centre[1] - H / 4)))
    wave = lambda f: np.fft.ifft2(f * a * phase).real.ravel()  # noqa: E731
    v = np.stack([wave(d[0]), wave(d[1]), np.zeros(nx * ny)], axis=1)
    scale = TINY * c / np.abs(v).max()
    z = np.zeros(nx * ny)
    # u = d f(n.x - c t): grad u = -(v/c) n.
    e = [-wave(d[0] * ex) / c, -wave(d[1] * ey) / c, z, -wave((d[0] * ey + d[1] * ex) / 2) / c, z, z]
    return v * scale, np.stack(e, axis=1) * scale, np.arctan2(ky, kx), a**2


# Angle, kind, and twice: wavelength, length, width (standard deviations), all in cells.
OBLIQUE = [
    (30, "P", (10, 6, 12), (14, 8.4, 16.8)),
    (60, "P", (14, 8, 18), (20, 11.4, 25.7)),
    (30, "S", (14, 8, 16), (20, 11.4, 22.9)),
]


@pytest.mark.parametrize(("degrees", "kind", "coarse", "fine"), OBLIQUE)
def test_oblique_incidence(degrees, kind, coarse, fine):
    """The reflected energy of a packet falls to Lysmer and Kuhlemeyer's as its waves are resolved better.

    The excess is the discretisation's, second order in the amplitude or better; what two resolutions extrapolate to (second
    order) is within 0.004 of the packet's energy.
    """
    results = [measured_reflection(degrees, kind, *size) for size in (coarse, fine)]
    excess = [got - theory for got, theory in results]
    ratio = fine[0] / coarse[0]
    order = np.log(excess[0] / excess[1]) / np.log(ratio)
    limit = results[1][0] + (results[1][0] - results[0][0]) / (ratio**2 - 1)
    print(
        f"{kind} at {degrees} deg: excess {excess[0]:.5f}, {excess[1]:.5f}, order {order:.2f}; "
        f"extrapolated {limit:.5f}, theory {results[1][1]:.5f}"
    )
    assert order > 1.5
    assert limit == pytest.approx(results[1][1], abs=0.004)


def measured_reflection(degrees, kind, wavelength, long, wide):
    """Reflected share of a packet's energy, measured and by theory."""
    theta = np.radians(degrees)
    c = CD if kind == "P" else CS
    # In space the deviations are those of the amplitude; 3.4 of them to either side.
    half_x = 3.4 * np.hypot(long * np.cos(theta), wide * np.sin(theta))
    half_y = 3.4 * np.hypot(long * np.sin(theta), wide * np.cos(theta))
    path = half_x / np.cos(theta)  # to the face
    # A slow reflected SV needs more time to come clear; a fast P runs further.
    cells = int(2 * half_x) + 4, int(2 * half_y + (2.2 if kind == "P" else 2.6) * path * np.sin(theta)) + 4
    centre = np.array([cells[0] - half_x, half_y]) * H
    v, strain, angle, weight = packet(kind, theta, wavelength, long, wide, cells, centre)
    position = lattice((0, 0, 0), (2 * cells[0], 2 * cells[1], 1), (H / 2, H / 2, H))
    volume = H**3 / 4
    faces = [FREE, TRANSMITTING, FREE, FREE, SYMMETRY, SYMMETRY]
    s = solver(
        (0, 0, 0),
        H,
        (*cells, 1),
        faces,
        [material()],
        options("usavg", cfl=0.6),
        [(position, v, volume, RHO, 0)],
        threads=2,
    )
    set_strain(s, strain, volume)
    initial = s.ledger()["kinetic"] + strain_energy(s, volume)
    s.advance(10**6, 2 * path * H / c)
    final = s.ledger()["kinetic"] + strain_energy(s, volume)

    # Theory for this very packet: its plane waves, each at its own angle, weighted by their energy.
    hit = (np.cos(angle) > 0.05) & (weight > 1e-8 * weight.max())
    each = np.array([reflected_energy(abs(t), kind) for t in angle[hit]])
    p_theory, s_theory = np.average(each, axis=0, weights=weight[hit])
    got, theory = final / initial, p_theory + s_theory
    absorbed = s.ledger()["absorbed"] / initial
    print(
        f"  {wavelength} cells a wave, {len(position)} points, {s.cycle} steps: reflected {got:.5f}, theory {theory:.5f}, "
        f"absorbed + left {absorbed + got:.5f}"
    )
    # What is missing is the dissipation of waves so short.
    assert absorbed + got == pytest.approx(1, abs=0.02)
    return got, theory


# ---- areas ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", ["trilinear", "quadratic"])
@pytest.mark.parametrize("filled", [(4, 4, 4), (2, 3, 4)])
@pytest.mark.parametrize("direction", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, -2, 3)])
def test_areas_of_edges_and_corners(shape, filled, direction):
    """A block in the corner of three transmitting faces, moving rigidly: the force on it is -sum rho c A v, exactly."""
    cells = 4
    v = TINY * CD * np.array(direction, dtype=float)
    position = lattice((0, 0, 0), [2 * n for n in filled], H / 2)
    volume = H**3 / 8
    s = solver(
        (0, 0, 0),
        H,
        (cells,) * 3,
        [TRANSMITTING, FREE] * 3,
        [material()],
        options("usf", shape),
        [(position, v, volume, RHO, 0)],
    )
    area = np.array([filled[1] * filled[2], filled[0] * filled[2], filled[0] * filled[1]]) * H**2
    impedance = np.array([sum(area[b] * RHO * (CD if a == b else CS) for b in range(3)) for a in range(3)])
    before = by_id(s, "velocity")
    dt = 1e-6 * H / CD  # so short that nodes do not slow down within it (relative error Z dt/2m ~ 1e-5)
    s.advance(1, dt)
    change = ((by_id(s, "velocity") - before) * RHO * volume).sum(axis=0) / dt
    # Where nothing moves the force is zero to round-off; scale by the largest.
    difference = np.abs(change + impedance * v).max() / np.abs(impedance * v).max()
    absorbed = s.ledger()["absorbed"] / dt / (impedance * v**2).sum() - 1
    print(f"{shape} {filled} {direction}: force off by {difference:.1e}, absorbed power by {absorbed:+.1e}")
    assert difference < 2e-5
    assert abs(absorbed) < 2e-5
