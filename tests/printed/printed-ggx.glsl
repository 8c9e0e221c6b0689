/*---
provides = ["model"]
name = "printed-ggx"
title = "GGX with its formulas evaluated as they are printed"
source = "Walter et al. 2007, eq. 33, along both axes; Heitz 2014, eq. 72 and 99; for comparison with shaders/common/ggx.glsl"
anisotropic = true
[parameters.f0]
min = 0.0
max = 1.0
default = 1.0
[parameters.mx]
min = 0.001
max = 10.0
default = 0.3
[parameters.my]
min = 0.001
max = 10.0
default = 0.3
---*/

// tan^2 over the direction of w times alpha^2, from the cosine.
float scaled_tangent2(vec3 w, vec2 alpha) {
    float sine2 = 1.0 - w.z * w.z, tangent2 = sine2 / (w.z * w.z);
    vec2 direction = w.xy * alpha;
    return sine2 > 0.0 ? tangent2 * dot(direction, direction) / sine2 : 0.0;
}

float lambda(vec3 w) {
    return 0.5 * (-1.0 + sqrt(1.0 + scaled_tangent2(w, vec2(mx, my))));
}

float brdf(vec3 wi, vec3 wo) {
    vec3 h = normalize(wi + wo);
    float cosine2 = h.z * h.z, rest = 1.0 + scaled_tangent2(h, 1.0 / vec2(mx, my));
    float d = 1.0 / (PI * mx * my * cosine2 * cosine2 * rest * rest);
    float g = 1.0 / (1.0 + lambda(wi) + lambda(wo));
    float f = f0 + (1.0 - f0) * pow(1.0 - dot(wo, h), 5.0);
    return wi.z > 0.0 && wo.z > 0.0 ? f * d * g / (4.0 * wi.z * wo.z) : 0.0;
}
