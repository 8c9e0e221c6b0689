/*---
provides = ["model"]
name = "not-reciprocal"
title = "Lambert, darker for oblique views only"
source = "a planted bug"
---*/

float brdf(vec3 wi, vec3 wo) {
    return INV_PI * (0.5 + 0.5 * wo.z);
}
