/*---
provides = ["technique"]
name = "half-vector-cosine"
title = "Beckmann half vector + cosine (mixture)"
source = "one-sample mixture of the sampling of Kurt, Szirmay-Kalos, Krivanek 2010, eq. 16 to 20, and of a cosine lobe"
models = ["kurt", "kurt-coupled"]
uses = ["mx", "my"]
below_horizon = true
mixture = true
[left_out]
"half-vector lobe" = { lobe_probability = 0.0 }
"cosine lobe" = { lobe_probability = 1.0 }
[parameters.lobe_probability]
min = 0.0
max = 1.0
default = 0.5
unit = ""
help = "probability of the half-vector lobe; cosine otherwise"
---*/
#include "common/beckmann.glsl"
#include "common/hemisphere.glsl"
#include "common/mixture.glsl"

float direction_pdf(vec3 wo, vec3 wi) {
    float lobe = beckmann_density(lobe_probability, half_vector(wi, wo), mx, my);
    return lobe + (1.0 - lobe_probability) * INV_PI * max(wi.z, 0.0);
}

// The density is taken at the rounded direction, where the model is evaluated too: what both share cancels.
DirectionSample sample_direction(vec3 wo, vec2 u) {
    bool lobe = u.x < lobe_probability; // never at probability 0, so u1 / P is not 0/0
    vec2 v = vec2(lobe ? u.x / lobe_probability : stretched(u.x, lobe_probability), u.y);
    vec3 wi = lobe ? reflect_about(wo, beckmann_slope(v, mx, my)) : cosine_hemisphere(v).wi;
    return DirectionSample(wi, direction_pdf(wo, wi));
}
