/*---
provides = ["model"]
name = "energy"
title = "Lambert with a bright rim: more light leaves than arrives"
source = "a planted bug"
---*/

float brdf(vec3 wi, vec3 wo) {
    return INV_PI * (1.0 + 0.05 * (1.0 - wi.z) * (1.0 - wo.z));
}
