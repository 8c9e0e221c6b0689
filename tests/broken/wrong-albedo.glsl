/*---
provides = ["model"]
name = "wrong-albedo"
title = "Lambert that declares an albedo it does not have"
source = "a planted bug"
---*/

float brdf(vec3 wi, vec3 wo) {
    return 0.8 * INV_PI;
}

float directional_albedo(float mu) {
    return 0.79;
}
