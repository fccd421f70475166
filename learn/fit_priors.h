#pragma once

#include <span>

#include "camera/stereo_rig.h"
#include "estimator/fitted_priors.h"
#include "learn/stereo_tuple.h"

namespace windhover {

/// Flights, of 20 tuples at least, that priors are fitted to.
inline constexpr std::size_t kLeastFlights = 3;

/// The priors that the training tuples of a rig teach, robustly:
///
/// 1. Each flight's disparity offset and the length by which its labels exceed ranges. The
///    offsets' median is offset_px, the lengths' mean is lever_m; a label's excess differs from
///    flight to flight where clocks disagree, and is taken from the labels for what follows.
/// 2. log(d cos θ) by width and height, least squares with Huber's weights.
/// 3. Noise of single frames from second differences in time, which need no label. What else
///    varies in the error of size is split by flight into what stays and what drifts.
///
/// `tuples` are in order of flight, then time. @throws std::invalid_argument if fewer than 3
/// flights have 20 tuples, or a tuple has no rays or no positive label.
FittedPriors FitPriors(std::span<const StereoTuple> tuples, const StereoRig& rig);

}  // namespace windhover
