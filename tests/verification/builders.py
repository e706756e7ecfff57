"""Small builders that the verification tests share."""

import importlib

import numpy as np
import pytest

import pockmark._core as core

# The kernels by themselves, compiled as the core that was chosen is.
kernels = importlib.import_module(f"pockmark._kernels_{core.build_info()['isa']}")

THREADS = 1  # these are small: more threads only wait for each other
FREE, SYMMETRY, FIXED = core.Face.free, core.Face.symmetry, core.Face.fixed
TRANSMITTING = core.Face.transmitting

PRECISIONS = pytest.mark.parametrize("single", [False, True], ids=["fp64", "fp32"])

# Al 2024 as the paper has it.
RHO, C0, S, GAMMA0 = 2770.0, 5330.0, 1.34, 2.0
SHEAR = 73.0e9 / (2 * 1.33)


def law(model, **constants):
    """A law as a scene gives it, SI."""
    return {"model": model} | constants


def material(
    eos, strength, *, density=RHO, failure=None, q=(0.0, 0.0), t_melt=775.0, heating=1.0, specific_heat=875.0
):
    return core.Material(
        eos=eos,
        strength=strength,
        failure=failure or law("none"),
        density=density,
        specific_heat=specific_heat,
        taylor_quinney=heating,
        room_temperature=293.0,
        melt_temperature=t_melt,
        q_quadratic=q[0],
        q_linear=q[1],
    )


def elastic(young, nu, density):
    """Linear elastic solid without viscosity."""
    bulk, shear = young / (3 * (1 - 2 * nu)), young / (2 * (1 + nu))
    return material(law("linear", bulk_modulus=bulk), law("elastic", shear_modulus=shear), density=density)


def paper_eos():
    return law("mie-gruneisen", c0=C0, s=S, gamma0=GAMMA0)


def perfectly_plastic(shear, yield_stress):
    """Johnson-Cook without hardening or rate; without heat in a material that does not melt."""
    return johnson_cook(shear_modulus=shear, A=yield_stress, B=0.0, n=1.0, C=0.0)


def johnson_cook(**changed):
    """The paper's strength, with what is changed."""
    paper = {"shear_modulus": SHEAR, "A": 265e6, "B": 426e6, "n": 0.34, "C": 0.015, "m": 1.0}
    return law("johnson-cook", **paper | changed)


def aluminium(failure=None):
    """Al 2024 of the paper; without failure unless one is given."""
    return material(paper_eos(), johnson_cook(), failure=failure, q=(1.5, 0.06))


def options(
    scheme="usavg",
    shape="trilinear",
    *,
    cfl=0.5,
    cutoff=0.0,
    pic=0.0,
    strain_limit=0.2,
    volume="points",
    nodes="mean",
    filtering=(0, 0, 0.0),
    sleep=True,
):
    """Return the core's options; `filtering` is a filter's interval, order and share of the pressure."""
    return core.Options(
        scheme=getattr(core.Scheme, scheme),
        shape=getattr(core.ShapeFunction, shape),
        volumetric_strain=getattr(core.VolumetricStrain, volume),
        node_velocity=getattr(core.AtNodes, nodes),
        cfl=cfl,
        strain_limit=strain_limit,
        pic_fraction=pic,
        mass_cutoff=cutoff,
        sleep=sleep,
        filter_interval=filtering[0],
        filter_order=filtering[1],
        pressure_filter=filtering[2],
    )


def lattice(lower, counts, pitch):
    """Centres of a lattice of counts[0] x counts[1] x counts[2] bricks of size pitch; x slowest."""
    pitch = np.broadcast_to(pitch, 3)
    axes = [lo + (np.arange(n) + 0.5) * d for lo, n, d in zip(lower, counts, pitch, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def solver(
    lower,
    cell,
    cells,
    faces,
    materials,
    opts,
    bodies,
    *,
    threads=THREADS,
    single=False,
    flies=None,
    friction=None,
    driver=core.DRIVER,
    axisymmetric=False,
):
    """bodies: (position, velocity, volume of a point or of each, density, index of the material).

    `flies`: of each material; `friction`: of the second material's contact with the first, None without contact.
    """
    out = core.solver(single=single, driver=driver)(
        lower=tuple(float(x) for x in lower),
        cell=float(cell),
        cells=tuple(int(n) for n in cells),
        faces=list(faces),
        materials=materials,
        options=opts,
        threads=threads,
        axisymmetric=axisymmetric,
    )
    if flies:
        out.let_fly(flies)
    if friction is not None:
        out.set_contact([0, 1], friction)
    for position, velocity, volume, density, body in bodies:
        n = len(position)
        v = np.ascontiguousarray(np.broadcast_to(velocity, (n, 3)), dtype=float)
        each = np.full(n, volume, dtype=float)
        out.add_points(
            position=np.ascontiguousarray(position),
            velocity=v,
            mass=density * each,
            volume=each,
            body=np.full(n, body, dtype=np.uint8),
        )
    out.initialize()
    return out


def by_id(s, name):
    """A field in the order in which the points were added."""
    return s.field(name)[np.argsort(s.field("id"))]


def set_by_id(s, name, values):
    s.set_field(name, np.ascontiguousarray(np.asarray(values, dtype=float)[s.field("id")]))


def momentum(s):
    ledger = s.ledger()
    return np.array([ledger["momentum_x"], ledger["momentum_y"], ledger["momentum_z"]])
