/*---
provides = ["model"]
name = "kurt-plausible"
title = "Kurt, physically plausible"
source = "Kurt, Szirmay-Kalos, Krivanek 2010, eq. 9"
anisotropic = true
singular = ["albedo above 1 at grazing for slopes above 1.881"]
black = { ks = 0.0 }
[left_out]
"Fresnel term" = { f0 = 1.0 }
[parameters.ks]
min = 0.0
max = 1.0
default = 1.0
unit = ""
help = "specular reflectance, one colour channel"
[parameters.f0]
min = 0.0
max = 1.0
default = 1.0
unit = ""
help = "Fresnel reflectance at normal incidence"
[parameters.mx]
min = 0.001
max = 10.0
default = 0.3
unit = ""
help = "root mean square slope of the facets along x"
[parameters.my]
min = 0.001
max = 10.0
default = 0.3
unit = ""
help = "root mean square slope of the facets along y"
---*/
#include "common/beckmann.glsl"

float brdf(vec3 wi, vec3 wo) {
    HalfVector h = half_vector(wi, wo);
    float scale = 0.25 * beckmann_scale(h, mx, my);
    float f = exponential_ratio(ks * schlick(f0, h), scale, beckmann_exponent(h, mx, my), h.to_view, max(wi.z, wo.z));
    return wi.z > 0.0 && wo.z > 0.0 ? f : 0.0;
}
