/*---
provides = ["technique"]
name = "printed-ggx-vndf-caps"
title = "Spherical caps of GGX with their formulas evaluated as they are printed"
source = "Dupuy and Benyoub, Sampling Visible GGX Normals with Spherical Caps (2023); for comparison with shaders/common/ggx-visible.glsl"
models = ["ggx"]
uses = ["mx", "my"]
below_horizon = true
---*/

float direction_pdf(vec3 wo, vec3 wi) {
    vec3 h = normalize(wi + wo);
    vec3 scaled = vec3(h.xy / vec2(mx, my), h.z);
    float d = 1.0 / (PI * mx * my * dot(scaled, scaled) * dot(scaled, scaled));
    float lambda = 0.5 * (-1.0 + sqrt(1.0 + dot(wo.xy * vec2(mx, my), wo.xy * vec2(mx, my)) / (wo.z * wo.z)));
    return h.z > 0.0 ? d / (1.0 + lambda) / (4.0 * wo.z) : 0.0;
}

DirectionSample sample_direction(vec3 wo, vec2 u) {
    vec3 v = normalize(vec3(wo.xy * vec2(mx, my), wo.z));
    float phi = 2.0 * PI * u.y;
    float z = (1.0 - u.x) * (1.0 + v.z) - v.z;
    float sine = sqrt(clamp(1.0 - z * z, 0.0, 1.0));
    vec3 n = vec3(sine * cos(phi), sine * sin(phi), z) + v;
    vec3 h = normalize(vec3(n.xy * vec2(mx, my), n.z));
    vec3 wi = 2.0 * dot(wo, h) * h - wo;
    return DirectionSample(wi, direction_pdf(wo, wi));
}
