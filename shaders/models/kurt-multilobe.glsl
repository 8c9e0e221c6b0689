/*---
provides = ["model"]
name = "kurt-multilobe"
title = "Kurt, two lobes"
source = "Kurt, Szirmay-Kalos, Krivanek 2010, eq. 14 with two lobes"
anisotropic = true
singular = ["grows like cos^-alpha at grazing for every alpha above 0"]
black = { kd = 0.0, ks1 = 0.0, ks2 = 0.0 }
[left_out]
"diffuse lobe" = { kd = 0.0 }
"lobe 1" = { ks1 = 0.0 }
"lobe 2" = { ks2 = 0.0 }
"Fresnel term of lobe 1" = { f01 = 1.0 }
"Fresnel term of lobe 2" = { f02 = 1.0 }
"shadowing term of lobe 1" = { alpha1 = 0.0 }
"shadowing term of lobe 2" = { alpha2 = 0.0 }
[parameters.kd]
min = 0.0
max = 1.0
default = 0.0
unit = ""
help = "diffuse reflectance, one colour channel"
[parameters.ks1]
min = 0.0
max = 1.0
default = 0.5
unit = ""
help = "specular reflectance, one colour channel, lobe 1"
[parameters.f01]
min = 0.0
max = 1.0
default = 1.0
unit = ""
help = "Fresnel reflectance at normal incidence, lobe 1"
[parameters.mx1]
min = 0.001
max = 10.0
default = 0.1
unit = ""
help = "root mean square slope of the facets along x, lobe 1"
[parameters.my1]
min = 0.001
max = 10.0
default = 0.1
unit = ""
help = "root mean square slope of the facets along y, lobe 1"
[parameters.alpha1]
min = 0.0
max = 1.9
default = 0.0
unit = ""
help = "exponent of the shadowing term (ci co)^-alpha, lobe 1"
[parameters.ks2]
min = 0.0
max = 1.0
default = 0.5
unit = ""
help = "specular reflectance, one colour channel, lobe 2"
[parameters.f02]
min = 0.0
max = 1.0
default = 1.0
unit = ""
help = "Fresnel reflectance at normal incidence, lobe 2"
[parameters.mx2]
min = 0.001
max = 10.0
default = 0.5
unit = ""
help = "root mean square slope of the facets along x, lobe 2"
[parameters.my2]
min = 0.001
max = 10.0
default = 0.5
unit = ""
help = "root mean square slope of the facets along y, lobe 2"
[parameters.alpha2]
min = 0.0
max = 1.9
default = 0.25
unit = ""
help = "exponent of the shadowing term (ci co)^-alpha, lobe 2"
---*/
#include "common/kurt.glsl"

float brdf(vec3 wi, vec3 wo) {
    HalfVector h = half_vector(wi, wo);
    float first = kurt_lobe(h, wi.z, wo.z, ks1 * schlick(f01, h), mx1, my1, alpha1);
    float second = kurt_lobe(h, wi.z, wo.z, ks2 * schlick(f02, h), mx2, my2, alpha2);
    float f = kd * INV_PI + first + second;
    return wi.z > 0.0 && wo.z > 0.0 ? f : 0.0;
}
