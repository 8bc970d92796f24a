"""Every tolerance of the suite, in one place, each with its reason.

A tolerance is derived before it is met: from the rounding of the types that take part, the
number of operations, and the condition of the problem. A case that exceeds one is mended
in the library. 0 means bit for bit, or not once.
"""

from visuohaptic.stability.tolerances import BITS, U64, Tolerance

U32 = 2.0**-24
"""Unit rounding of float32, 6.0e-8."""

NEVER = "no count of failures but none is acceptable"

TOLERANCES = {
    # ------------------------------------------------------------------ invariance
    "invariance/scale by a power of two": Tolerance(
        0, "bits", "multiplying by 2^k changes no digit, and the box is divided out first"
    ),
    "invariance/vertices, any scale": Tolerance(
        4 * U32,
        "object radii",
        "float64 rounding of a scale may turn one rounding to float32: one ulp, 2^-23, a coordinate; "
        "the norm of three is below 4 u32",
    ),
    "invariance/vertices, offset up to 1e6 sizes": Tolerance(
        1e6 * 2**1.5 * 4 * U64 + 4 * U32,
        "object radii",
        "coordinates of size 1e6 lose 1e6 u64 each (a vertex, its box, its centroid), then one ulp "
        "of float32",
    ),
    "invariance/order, winding, corners, doubled vertices: vertices": Tolerance(
        4 * U32,
        "object radii",
        "sums over faces in another order differ by rounding of float64, which may turn one rounding "
        "to float32",
    ),
    "invariance/images": Tolerance(
        2e-3,
        "full scale",
        "vertices one ulp of float32 apart (2.4e-7) move an imprint by that over its depth range "
        "(0.1) and by 2e-7 over the relief where it is stretched (1e-4 at least)",
    ),
    "invariance/features": Tolerance(
        1e-3,
        "full scale",
        "the filter bank's largest singular value is 3.02, and a deviation averages over its band; "
        "images may move by 2e-3 in single points and by less in the mean",
    ),
    "invariance/fixated points": Tolerance(
        1e-5,
        "object radii",
        "the same pixel is fixated, and its ray meets a surface that moved by one ulp of float32, "
        "seen at no less than 1.4 degrees (1/sin = 40)",
    ),
    "invariance/saliency map": Tolerance(
        5e-3,
        "of the map's maximum",
        "planes are float32 and pass some 30 filters; the operator N squares a difference and is "
        "divided by FAINT_PEAK = 0.01: 30 · 2 · u32 / 0.01 = 4e-4 a map, eight maps",
    ),
    "invariance/tied peaks: fixations are those of a map within its error": Tolerance(
        1e-2,
        "of the map's maximum",
        "backward error: twice the map's tolerance of 5e-3; objects with symmetries have exact ties",
    ),
    "invariance/edges of more than two faces: curvature": Tolerance(
        100 * 8 * U64 / 1e-6,
        "1 / object radius",
        "the largest curvature, 3 / 0.03, times the rounding of the height of a face of at least 1e-6 radii: eight "
        "roundings of coordinates of size 1",
    ),
    "invariance/edges of more than two faces: saliency map": Tolerance(
        5e-3, "of the map's maximum", "as for other surfaces"
    ),
    "invariance/edges of more than two faces: fixated points": Tolerance(
        1e-5, "object radii", "as for other surfaces"
    ),
    "invariance/labels": Tolerance(0, "labels", NEVER),
    "invariance/turned object: saliency map": Tolerance(
        0.05,
        "of the map's maximum",
        "a turned mesh is rounded to float32 anew: pixels on an outline or an edge see another face "
        "(up to 1 in 10^4 pixels), and one pixel of 256² is 1/4 of a working pixel's certainty",
    ),
    "invariance/turned object: fixations are those of a map within its error": Tolerance(
        0.06,
        "of the map's maximum",
        "backward error: the chosen place is as salient as the best up to twice the map's own error "
        "here and TIE_TOLERANCE + INWARD_WEIGHT; which of two near ties is first is not a question that rounding can "
        "answer",
    ),
    "invariance/mirrored object: saliency map": Tolerance(
        0.05, "of the map's maximum", "as for the turned object"
    ),
    "invariance/mirrored object: fixations are those of a map within its error": Tolerance(
        0.06, "of the map's maximum", "as for the turned object"
    ),
    # ------------------------------------------------------------------ rays
    "rays/hits lie on their face's plane": Tolerance(
        64 * U64,
        "object radii",
        "a dot product, a difference and a quotient of float64 numbers of size 3: below 40 u64, "
        "measured along the normal (backward), so grazing rays count alike",
    ),
    "rays/face chosen against brute force in float64": Tolerance(
        0,
        "rays",
        "settled rays are decided in float64; only rays that pass within 1e-12 of an edge, where the "
        "oracle itself is unsure, are left to the exact test",
    ),
    "rays/against exact rationals, aimed at vertices and edges": Tolerance(
        64 * U64, "object radii", "as above; whether a face is met is decided in rationals"
    ),
    "rays/leaks out of closed surfaces": Tolerance(
        0, "rays", "two faces at an edge have opposite numbers for it: no ray slips between"
    ),
    "rays/grazing": Tolerance(
        16 * U64,
        "object radii",
        "along the normal; the distance itself has condition 1/sin of the angle",
    ),
    "rays/within a face's plane": Tolerance(
        0, "rays", "a miss or the face's rim; never NaN, never a point off the surface"
    ),
    "rays/through slivers of 1e-12 area": Tolerance(
        64 * U64,
        "object radii",
        "the plane of a sliver is known from its long edges; along the ray",
    ),
    "rays/coplanar faces on top of each other": Tolerance(
        0, "rays", "equal distances go to the lower face: the ray alone decides, not the batch"
    ),
    "rays/meshes far off centre": Tolerance(
        1e6 * 2**1.5 * 4 * U64 + 16 * U32,
        "object radii",
        "the vertices' own tolerance for such an offset, and 1/cos of at most 60 degrees",
    ),
    # ------------------------------------------------------------------ hard meshes
    "meshes/hard cases end in tables or in a refusal": Tolerance(0, "meshes", NEVER),
    "meshes/random wild surfaces": Tolerance(0, "meshes", NEVER),
    "meshes/fuzzed files: crash, hang, NaN or an unclear refusal": Tolerance(0, "files", NEVER),
    # ------------------------------------------------------------------ images
    "images/contourlet bands against exact rationals": Tolerance(
        2000 * U64,
        "of the largest pixel",
        "four ladder stages of two separable 12-tap filters and a 9-7 pyramid: some 150 products a "
        "coefficient, gain up to 3.02 a stage",
    ),
    "images/deviations of flat images": Tolerance(
        2000 * U64,
        "of the pixel value",
        "the exact value is 0; what is left is the bands' rounding, as above",
    ),
    "images/deviations against exact rationals": Tolerance(
        2000 * U64,
        "of the largest pixel",
        "two-pass sums of squares; an error relative to the image, for a band's own mean may cancel",
    ),
    "images/scale by a power of two": Tolerance(
        0,
        "bits",
        "no digit changes between 2^-1000 and 2^1000, sums are scaled before they are taken",
    ),
    "images/scale by 1e±150": Tolerance(
        2000 * U64, "relative", "one more rounding of each pixel, through the same sums"
    ),
    "images/contourlet reconstruction": Tolerance(
        3 * 2000 * U64,
        "of the largest pixel",
        "the decomposition's error of 2000 u64 once more through the inverse, whose gain is below 2, "
        "and the inverse's own: the same steps backwards",
    ),
    "images/moments of sequences against exact rationals": Tolerance(
        64 * U64,
        "of the root mean square",
        "two passes over at most 64 values; the mean's rounding enters squared",
    ),
    "images/skewness against exact rationals": Tolerance(
        2e-3,
        "1",
        "condition: a deviation of 1e-12 of the mean is what counts as constant; values are exact to "
        "u64 of the mean, so its third moment is known to 3 · 1.1e-16 / 1e-12 · 6",
    ),
    "images/skewness of well spread sequences": Tolerance(
        64 * U64 * 100,
        "1",
        "deviation at least a hundredth of the largest value: condition 100, two-pass sums",
    ),
    "images/wavelet levels against exact rationals": Tolerance(
        64 * U64, "of the largest value", "three levels of 4 products and 3 sums, gain √2 a level"
    ),
    "images/shape of imprints against exact rationals": Tolerance(
        1e-9,
        "1",
        "32² float32 values summed in float64, an exact quadric by least squares of condition 10; "
        "skewness of an imprint that varies by 1e-6 at least",
    ),
    "images/stretched imprints": Tolerance(0, "images", "within [0, 1], finite, contact stays 1"),
    # ------------------------------------------------------------------ attention
    "attention/maps are finite, within 0 and 1, zero beside the object": Tolerance(
        0, "views", NEVER
    ),
    "attention/fixations: distinct, on the object, a focus apart": Tolerance(0, "fixations", NEVER),
    "attention/way of the eye against its definition in float64": Tolerance(
        0,
        "fixations",
        "where no two places tie within 2 TIE_TOLERANCE, rounding of float32 (1e-7) can't change the order",
    ),
    "attention/brightness by a power of two": Tolerance(
        0, "bits", "brightness is divided out before anything else"
    ),
    "attention/pyramid against scipy.ndimage": Tolerance(
        16 * U32, "full scale", "two passes of three products in float32, and a mean of four"
    ),
    "attention/a uniform sphere's curvature": Tolerance(
        0.02,
        "relative",
        "second order in the edge, h² = 0.005 for 5120 faces, times about four for an icosphere's "
        "uneven triangles",
    ),
    # ------------------------------------------------------------------ learning
    "learning/every classifier ends in labels": Tolerance(0, "fits", NEVER),
    "learning/each standardised feature rescaled by 1e±8": Tolerance(0, "labels", NEVER),
    "learning/each standardised feature rescaled by powers of two": Tolerance(
        0, "bits", "mean and deviation scale exactly, so standardised values are the same bits"
    ),
    "learning/all features alike rescaled by 1e±8": Tolerance(0, "labels", NEVER),
    "learning/all features alike rescaled by powers of two": Tolerance(
        0,
        "bits",
        "distances, means and deviations all scale exactly, so the groups are the same and their "
        "standardised statistics the same bits",
    ),
    "learning/features changed by 1e-15": Tolerance(
        0,
        "labels",
        "five units in the last place of a feature are rounding, and rounding must not classify an object",
    ),
    "learning/standardised columns against exact rationals": Tolerance(
        1e-6,
        "standard deviations",
        "condition: mean over deviation up to 1e8, times n u64 (n = 64), so 64 · 1e8 u64 = 7e-7",
    ),
    "learning/map units stay within their touches": Tolerance(
        64 * U64, "of the data's extent", "weights are convex means; rounding of a sum of 64"
    ),
    # ------------------------------------------------------------------ precision
    "precision/imprint of a plane in closed form": Tolerance(
        2e-6,
        "full scale",
        "vertices of the wall are float32 (3e-8 each) over the depth range 0.1, and the image is "
        "float32: 2 · 3e-8 / 0.1 + 6e-8",
    ),
    "precision/frames on the surface": Tolerance(
        32 * U64, "1", "three vectors made square by one projection and one cross product"
    ),
    "precision/tessellated sphere": Tolerance(
        1.0,
        "of 1 - √(1 - e²/3)",
        "an even triangle of edge e has its corners on the unit sphere and its middle that far below "
        "(about e²/6); the corners' rounding to float32, 4 u32, is taken off first",
    ),
    "precision/values out of reach and beyond full scale": Tolerance(
        0, "points", "an image is clamped to [0, 1]; what is met nowhere is 0"
    ),
    "precision/sphere under the sensor": Tolerance(
        1e-4, "object radii", "edges of 0.02 on a unit sphere: e²/6 = 6e-5, and rounding to float32"
    ),
    # ------------------------------------------------------------------ determinism
    "determinism/batch split of kernels": Tolerance(0, "bits", BITS),
    "determinism/job order, processes and blocks of viewpoints": Tolerance(0, "tables", BITS),
    "determinism/kill -9 and restart": Tolerance(
        0, "kills", "tables are replaced in one step: a reader meets the old, the new, or none"
    ),
}
