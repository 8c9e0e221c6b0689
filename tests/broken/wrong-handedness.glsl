/*---
provides = ["technique"]
name = "wrong-handedness"
title = "A lobe beside the view, turned back into the surface frame with the wrong sign"
source = "a planted bug"
---*/
#include "common/frame.glsl"
#include "common/hemisphere.glsl"

// Density in the frame of the view: more where y is positive.
float sided(vec3 w) {
    return INV_PI * max(w.z, 0.0) * (w.y > 0.0 ? 1.5 : 0.5);
}

DirectionSample sample_direction(vec3 wo, vec2 u) {
    float v = u.y < 0.75 ? u.y / 1.5 : 0.5 + 2.0 * (u.y - 0.75);
    DirectionSample s = cosine_hemisphere(vec2(u.x, v));
    s.pdf = sided(s.wi);
    vec2 turn = azimuth(wo);
    s.wi = from_azimuth_frame(s.wi, vec2(turn.x, -turn.y));
    return s;
}

float direction_pdf(vec3 wo, vec3 wi) {
    return sided(to_azimuth_frame(wi, azimuth(wo)));
}
