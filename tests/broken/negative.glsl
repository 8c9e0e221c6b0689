/*---
provides = ["model"]
name = "negative"
title = "A lobe that goes below zero in forward scattering"
source = "a planted bug"
---*/

float brdf(vec3 wi, vec3 wo) {
    return 0.5 * INV_PI * (1.0 + 1.2 * dot(wi.xy, wo.xy));
}
