"""A file of the contract's form around the Oren-Nayar functions that the MaterialX package ships, read from the
package.

The wrapper calls them as that package's own BSDF (mx_oren_nayar_diffuse_bsdf) does, with the same clamps.
"""

from importlib.util import find_spec
from pathlib import Path

SHIPPED = (
    "stdlib/genglsl/lib/mx_math.glsl",
    "pbrlib/genglsl/lib/mx_microfacet.glsl",
    "pbrlib/genglsl/lib/mx_microfacet_diffuse.glsl",
)

HEAD = """/*---
provides = ["model"]
name = "{name}"
title = "Oren-Nayar as MaterialX ships it"
source = "the MaterialX package, pbrlib/genglsl"
[parameters.roughness]
min = 0.0
max = 1.0
default = 1.0
[parameters.albedo]
min = 0.0
max = 1.0
default = 1.0
---*/
#define DIRECTIONAL_ALBEDO_METHOD 0
#define fwidth abs
"""

WRAPPER = """
float brdf(vec3 wi, vec3 wo) {{
    float NdotV = clamp(wo.z, M_FLOAT_EPS, 1.0);
    float NdotL = clamp(wi.z, M_FLOAT_EPS, 1.0);
    float LdotV = clamp(dot(wi, wo), M_FLOAT_EPS, 1.0);
    vec3 diffuse = {call};
    return min(wi.z, wo.z) > 0.0 ? diffuse.x * M_PI_INV : 0.0;
}}
"""

CALLS = {
    "materialx-compensated": "mx_oren_nayar_compensated_diffuse(NdotV, NdotL, LdotV, roughness, vec3(albedo))",
    "materialx-qualitative": "vec3(mx_oren_nayar_diffuse(NdotV, NdotL, LdotV, roughness) * albedo)",
}


def write(folder: Path, name: str) -> Path:
    """Write the file for one of CALLS into the folder; its path."""
    spec = find_spec("MaterialX")
    libraries = Path(spec.origin).parent / "libraries"
    shipped = "".join((libraries / part).read_text(encoding="utf-8") for part in SHIPPED)
    code = "\n".join("" if line.lstrip().startswith("#include") else line for line in shipped.splitlines())
    path = folder / f"{name}.glsl"
    path.write_text(HEAD.format(name=name) + code + WRAPPER.format(call=CALLS[name]), encoding="utf-8")
    return path
