"""Writes the compiled kernel of every camera model, with analytic derivatives, from its equations.

A tool of development: ``python -m graphos_core.cameras.generator`` rewrites ``cameras/generated/``, which is checked
in, so the engine never needs SymPy. A test generates again and compares the bytes. The equations are differentiated
exactly; common subexpressions are computed once.

A forward model is two steps, the projection ray → (u, v) and the equations (u, v) → pixel, whose derivatives are
chained. A backward model gives (u, v) from the pixel; its kernel solves for the pixel by Newton's method and takes the
derivatives of the implicit function at the solution: with J = ∂(u, v)/∂(x, y), ∂pixel/∂(u, v) = J⁻¹ and
∂pixel/∂p = −J⁻¹ ∂(u, v)/∂p. It gets a second kernel for residuals in the corrected picture, which needs no solution.
"""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from graphos_core.cameras.model import CameraModel, camera_models
from graphos_core.cameras.projections import NO_IMAGE, PROJECTIONS

FOLDER = Path(__file__).parent / "generated"

_HEAD = '''"""Kernel of the camera model “{label}”.

Written by `graphos_core.cameras.generator` with SymPy {version} from `{module}`: do not edit.
"""

{imports}from numba import cfunc

from graphos_core.cameras.entry import SIGNATURE
from graphos_core.data.record import Array
'''

_KERNEL = '''

@cfunc(SIGNATURE, cache=True, error_model="numpy")
def {entry}(
    values: Array, x: float, y: float, z: float, pixel: Array, d_point: Array, d_values: Array, row: int
) -> int:
    """{what}; see `graphos_core.cameras.entry`."""
    if {no_image}:
        return 0
{body}    return 1
'''

_WHAT = {
    "entry": "Project one point with derivatives",
    "residual_entry": "Compare with the measured position that `pixel` holds, as `residual_code` says",
}


def kernel_source(model: CameraModel) -> str:
    """Return the text of the file with the kernel of a model whose equations are given."""
    import sympy

    if model.equations is None:
        raise ValueError(f"{model.name} has a kernel written by hand")
    ideal = _projection(sympy, model)
    kernels = {"entry": ideal + (_backward if model.backward else _forward)(sympy, model)}
    if model.backward:
        kernels["residual_entry"] = ideal + _at_measured(sympy, model)
    if model.projection == "spherical":
        kernels["residual_entry"] = _KEEP + kernels["entry"] + _UNWRAP
    used = set(re.findall(r"\w+", "".join(kernels.values())))
    functions = sorted(used & {"atan2", "pi", "sqrt"})
    text = _HEAD.format(
        label=model.label,
        version=sympy.__version__,
        module=model.equations.__module__,
        imports=f"from math import {', '.join(functions)}\n\n" if functions else "",
    )
    for name, body in kernels.items():
        text += _KERNEL.format(entry=name, what=_WHAT[name], body=body, no_image=NO_IMAGE[model.projection])
    return text


def write_all(folder: Path = FOLDER) -> list[Path]:
    """Write the kernels of all models; return the files."""
    written = []
    for model in camera_models().values():
        if model.equations is not None:
            path = folder / f"{model.name}_kernels.py"
            path.write_text(kernel_source(model), "utf-8")
            written.append(path)
    return written


def _symbols(sympy: Any, names: tuple[str, ...]) -> dict[str, Any]:
    return {name: sympy.Symbol(name, real=True) for name in names}


def _projection(sympy: Any, model: CameraModel) -> str:
    """Return the lines that compute u, v and their derivatives by x, y, z."""
    point = _symbols(sympy, ("x", "y", "z"))
    u, v = PROJECTIONS[model.projection](sympy, *point.values())
    named = {"u": u, "v": v}
    for name, value in (("u", u), ("v", v)):
        named |= {f"{name}_{axis}": sympy.diff(value, symbol) for axis, symbol in point.items()}
    return _assignments(sympy, named, "s")


def _forward(sympy: Any, model: CameraModel) -> str:
    """Return the lines from (u, v) to the pixel, chained with the derivatives of the projection."""
    assert model.equations is not None
    ideal, parameters = _symbols(sympy, ("u", "v")), _symbols(sympy, model.names)
    outputs = model.equations(SimpleNamespace(**parameters), *ideal.values())
    named = {f"pixel[{i}]": value for i, value in enumerate(outputs)}
    for i, value in enumerate(outputs):
        named |= {f"{'xy'[i]}_{name}": sympy.diff(value, symbol) for name, symbol in ideal.items()}
        named |= {_inner(i, k): sympy.diff(value, symbol) for k, symbol in enumerate(parameters.values())}
    return _read(model) + _assignments(sympy, named, "t") + _CHAIN


def _backward(sympy: Any, model: CameraModel) -> str:
    """Return the lines that solve the equations for the pixel and differentiate the solution."""
    residual, inner = _from_measured(sympy, model)
    lines = _read(model) + _SOLVE.format(equations=_assignments(sympy, residual, "t", 8))
    lines += _assignments(sympy, inner, "w")
    for k in range(len(model.parameters)):
        lines += f"    {_inner(0, k)} = -(x_u * u_p{k} + x_v * v_p{k})\n"
        lines += f"    {_inner(1, k)} = -(y_u * u_p{k} + y_v * v_p{k})\n"
    return lines + _CHAIN


def _at_measured(sympy: Any, model: CameraModel) -> str:
    """Return the lines that compare the ideal position with the corrected measured one, times f."""
    residual, inner = _from_measured(sympy, model)
    now = {name: residual[name] for name in ("u_now", "v_now")}
    lines = _read(model) + "    px = pixel[0]\n    py = pixel[1]\n" + _assignments(sympy, now | inner, "t")
    lines += "    pixel[0] = px + focal_px * (u - u_now)\n    pixel[1] = py + focal_px * (v - v_now)\n"
    for i, axis in enumerate("uv"):
        lines += f"    {_inner(i, 0)} = {axis} - {axis}_now - focal_px * {axis}_p0\n"
        for k in range(1, len(model.parameters)):
            lines += f"    {_inner(i, k)} = -focal_px * {axis}_p{k}\n"
        lines += "".join(f"    d_point[{3 * i + k}] = focal_px * {axis}_{d}\n" for k, d in enumerate("xyz"))
    return lines


def _from_measured(sympy: Any, model: CameraModel) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the ideal position of a pixel with its derivatives by the pixel, and those by the parameters."""
    assert model.equations is not None
    measured, parameters = _symbols(sympy, ("px", "py")), _symbols(sympy, model.names)
    outputs = model.equations(SimpleNamespace(**parameters), *measured.values())
    residual = {f"{'uv'[i]}_now": value for i, value in enumerate(outputs)}
    for i, value in enumerate(outputs):
        residual |= {f"{'uv'[i]}_{name}": sympy.diff(value, symbol) for name, symbol in measured.items()}
    inner: dict[str, Any] = {}
    for k, symbol in enumerate(parameters.values()):
        inner |= {f"{'uv'[i]}_p{k}": sympy.diff(value, symbol) for i, value in enumerate(outputs)}
    return residual, inner


_CHAIN = "".join(
    f"    d_point[{3 * i + k}] = {'xy'[i]}_u * u_{axis} + {'xy'[i]}_v * v_{axis}\n"
    for i in range(2)
    for k, axis in enumerate("xyz")
)

_KEEP = "    measured = pixel[0]\n"

_UNWRAP = """    turns = round((measured - pixel[0]) / (2.0 * pi * focal_px))
    pixel[0] += 2.0 * pi * focal_px * turns
    d_values[0] += 2.0 * pi * turns
"""

_SOLVE = """    px = focal_px * u + x0
    py = focal_px * v + y0
    limit = 1e-11 / focal_px
    found = False
    for _ in range(30):
{equations}        determinant = u_px * v_py - u_py * v_px
        if not determinant > 0.0:
            return 0
        du = u - u_now
        dv = v - v_now
        if found:
            break
        found = abs(du) + abs(dv) < 1e4 * limit  # one more step squares what is left
        px += (v_py * du - u_py * dv) / determinant
        py += (u_px * dv - v_px * du) / determinant
    if not found:
        return 0
    pixel[0] = px
    pixel[1] = py
    x_u = v_py / determinant
    x_v = -u_py / determinant
    y_u = -v_px / determinant
    y_v = u_px / determinant
"""


def _inner(i: int, k: int) -> str:
    """Return the element ∂pixel_i/∂value_k: the rows lie `row` numbers apart."""
    return f"d_values[{k}]" if i == 0 else f"d_values[row + {k}]"


def _read(model: CameraModel) -> str:
    return "".join(f"    {name} = values[{k}]\n" for k, name in enumerate(model.names))


def _assignments(sympy: Any, named: dict[str, Any], prefix: str, indent: int = 4) -> str:
    """Return lines that compute every named expression, common subexpressions first."""
    shared, values = sympy.cse(
        list(named.values()), sympy.numbered_symbols(prefix, real=True), order="canonical", list=False
    )
    write, space = _printer(), " " * indent
    lines = [f"{space}{symbol} = {write(value)}\n" for symbol, value in shared]
    lines += [
        f"{space}{name} = {write(sympy.Float(value) if value.is_Integer else value)}\n"
        for name, value in zip(named, values, strict=True)
    ]
    return "".join(lines)


def _printer() -> Any:
    """Return the function that writes an expression as Python with powers as products."""
    from sympy.printing.precedence import PRECEDENCE
    from sympy.printing.pycode import PythonCodePrinter

    class Printer(PythonCodePrinter):
        def _print_Pow(self, expr: Any, rational: bool = False) -> str:
            base, exponent = self.parenthesize(expr.base, PRECEDENCE["Atom"], strict=True), abs(expr.exp)
            if exponent.is_Integer:
                factors = [base] * int(exponent)
            elif exponent.q == 2:
                factors = [f"sqrt({self._print(expr.base)})"] + [base] * (int(exponent.p) // 2)
            else:
                raise ValueError(f"no rule to write {expr}")
            power = factors[0] if len(factors) == 1 else f"({'*'.join(factors)})"
            return power if expr.exp > 0 else f"(1.0 / {power})"

        def _print_Float(self, expr: Any) -> str:
            return repr(float(expr))

    printer = Printer({"fully_qualified_modules": False})
    return printer.doprint


if __name__ == "__main__":
    write_all()
