/*---
provides = ["model"]
name = "kurt-coupled"
title = "Kurt, diffuse coupled by Fresnel"
source = "Kurt, Szirmay-Kalos, Krivanek 2010, eq. 13"
anisotropic = true
singular = ["grows like cos^-alpha at grazing for every alpha above 0"]
black = { kd = 0.0, ks = 0.0 }
[left_out]
"diffuse lobe" = { kd = 0.0 }
"specular lobe" = { ks = 0.0 }
"Fresnel term" = { f0 = 1.0 }
"shadowing term" = { alpha = 0.0 }
[parameters.kd]
min = 0.0
max = 1.0
default = 0.5
unit = ""
help = "diffuse reflectance, one colour channel"
[parameters.ks]
min = 0.0
max = 1.0
default = 0.5
unit = ""
help = "specular reflectance, one colour channel"
[parameters.f0]
min = 0.0
max = 1.0
default = 0.05
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
[parameters.alpha]
min = 0.0
max = 1.9
default = 0.25
unit = ""
help = "exponent of the shadowing term (ci co)^-alpha"
---*/
#include "common/kurt.glsl"

float brdf(vec3 wi, vec3 wo) {
    HalfVector h = half_vector(wi, wo);
    float specular = kurt_lobe(h, wi.z, wo.z, ks * schlick(f0, h), mx, my, alpha);
    float f = kd * schlick_rest(f0, h) * INV_PI + specular;
    return wi.z > 0.0 && wo.z > 0.0 ? f : 0.0;
}
