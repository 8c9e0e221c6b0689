/*---
provides = ["model"]
name = "lambert"
title = "Lambert"
source = "Lambert's cosine law: f = rho/pi"
black = { albedo = 0.0 }
[left_out]
"albedo factor" = { albedo = 1.0 }
[parameters.albedo]
min = 0.0
max = 1.0
default = 1.0
unit = ""
help = "reflected fraction of the light, one colour channel"
---*/

float brdf(vec3 wi, vec3 wo) {
    return wi.z > 0.0 && wo.z > 0.0 ? albedo * INV_PI : 0.0;
}

float directional_albedo(float mu) {
    return albedo;
}
