//! Colour maps given by stops in equal steps, sRGB bytes, linear in between.

/// Every fifth row of viridis by Smith, van der Walt and Firing (2015), released as CC0; at most one
/// byte step from the full table.
pub(super) const VIRIDIS: &[[u8; 3]] = &[
    [68, 1, 84],
    [70, 8, 92],
    [71, 16, 99],
    [72, 23, 105],
    [72, 29, 111],
    [72, 36, 117],
    [71, 42, 122],
    [70, 48, 126],
    [69, 55, 129],
    [67, 61, 132],
    [65, 66, 135],
    [63, 72, 137],
    [61, 78, 138],
    [58, 83, 139],
    [56, 89, 140],
    [53, 94, 141],
    [51, 99, 141],
    [49, 104, 142],
    [46, 109, 142],
    [44, 113, 142],
    [42, 118, 142],
    [41, 123, 142],
    [39, 128, 142],
    [37, 132, 142],
    [35, 137, 142],
    [33, 142, 141],
    [32, 146, 140],
    [31, 151, 139],
    [30, 156, 137],
    [31, 161, 136],
    [33, 165, 133],
    [36, 170, 131],
    [40, 174, 128],
    [46, 179, 124],
    [53, 183, 121],
    [61, 188, 116],
    [70, 192, 111],
    [80, 196, 106],
    [90, 200, 100],
    [101, 203, 94],
    [112, 207, 87],
    [124, 210, 80],
    [137, 213, 72],
    [149, 216, 64],
    [162, 218, 55],
    [176, 221, 47],
    [189, 223, 38],
    [202, 225, 31],
    [216, 226, 25],
    [229, 228, 25],
    [241, 229, 29],
    [253, 231, 37],
];

/// Every seventeenth row of cividis by Nuñez, Anderton and Renslow (2018), "Optimizing colormaps with
/// consideration for color vision deficiency to enable accurate interpretation of scientific data".
pub(super) const CIVIDIS: &[[u8; 3]] = &[
    [0, 34, 78],
    [0, 46, 108],
    [30, 58, 111],
    [53, 69, 108],
    [71, 81, 108],
    [87, 93, 109],
    [102, 105, 112],
    [117, 117, 117],
    [132, 130, 121],
    [148, 142, 119],
    [165, 156, 116],
    [183, 169, 110],
    [200, 184, 102],
    [219, 199, 90],
    [238, 214, 73],
    [254, 232, 56],
];

/// Blue, cyan, green, yellow, red: the fringe colours of older post-processors.
pub(super) const RAINBOW: &[[u8; 3]] = &[
    [0, 0, 255],
    [0, 255, 255],
    [0, 255, 0],
    [255, 255, 0],
    [255, 0, 0],
];

/// Stamped files that are told apart, the first one first: away from the blue of the crash part, and from one
/// to the next in lightness too.
pub(super) const FILES: [[u8; 3]; 8] = [
    [240, 176, 58],
    [27, 140, 112],
    [204, 138, 190],
    [178, 60, 70],
    [190, 212, 90],
    [120, 86, 170],
    [242, 190, 190],
    [120, 84, 50],
];

/// What became of the elements of a mapping, from best to worst (mapped, partly, filled, near two sheets,
/// on two parts, too far, wrong normal, outside, without results): blues and greens carry values.
pub(super) const STATUSES: [[u8; 3]; 9] = [
    [70, 140, 190],
    [120, 190, 200],
    [130, 180, 110],
    [226, 196, 70],
    [214, 140, 50],
    [200, 80, 60],
    [170, 70, 140],
    [150, 150, 155],
    [90, 90, 95],
];
