/*---
provides = ["technique"]
name = "printed-cltc"
title = "Clipped LTC with its formulas evaluated as they are printed"
source = "Portsmouth, Kutz, Hill 2024 (EON), eq. 23 to 28; for comparison with the stable forms of shaders/common/ltc.glsl"
models = ["eon"]
uses = ["roughness"]
---*/
#include "common/frame.glsl"

struct Lobe {
    float a;
    float b;
    float c;
    float d;
};

Lobe lobe_of(float mu) {
    float r = roughness;
    float a = 1.0 + r * (0.303392 + (-0.518982 + 0.111709 * mu) * mu + (-0.276266 + 0.335918 * mu) * r);
    float b = r * (-1.16407 + 1.15859 * mu + (0.150815 - 0.150105 * mu) * r) / (mu * mu * mu - 1.43545);
    float c = 1.0 + (0.20013 + (-0.506373 + 0.261777 * mu) * mu) * r;
    float d = r * (0.540852 + (-1.01625 + 0.475392 * mu) * mu) / (-1.0743 + (0.0725628 + mu) * mu);
    return Lobe(a, b, c, d);
}

float share_above(Lobe lobe) {
    return 0.5 + 0.5 / sqrt(1.0 + lobe.d * lobe.d);
}

float density(Lobe lobe, vec3 w) {
    mat3 forward = mat3(lobe.a, 0.0, lobe.d, 0.0, lobe.c, 0.0, lobe.b, 0.0, 1.0);
    vec3 h = inverse(forward) * w;
    float squared = dot(h, h);
    float det = lobe.c * (lobe.a - lobe.b * lobe.d);
    return w.z > 0.0 ? max(h.z, 0.0) / (PI * det * squared * squared) / share_above(lobe) : 0.0;
}

DirectionSample sample_direction(vec3 wo, vec2 u) {
    Lobe lobe = lobe_of(wo.z);
    float radius = sqrt(1.0 - u.x), angle = 2.0 * PI * u.y;
    float x = radius * cos(angle), y = radius * sin(angle);
    float share = share_above(lobe);
    x = sqrt(1.0 - y * y) * (1.0 - share) + x * share;
    vec3 h = vec3(lobe.d > 0.0 ? x : -x, y, sqrt(1.0 - x * x - y * y));
    vec3 w = normalize(vec3(lobe.a * h.x + lobe.b * h.z, lobe.c * h.y, lobe.d * h.x + h.z));
    return DirectionSample(from_azimuth_frame(w, azimuth(wo)), density(lobe, w));
}

float direction_pdf(vec3 wo, vec3 wi) {
    return density(lobe_of(wo.z), to_azimuth_frame(wi, azimuth(wo)));
}
