#pragma once

namespace windhover {

inline constexpr double kSpeedOfLight_mps = 299'792'458;

/// Two radios that measure their distance by the time of flight of messages.
struct RangingExchange {
  double distance_m;
  double initiator_ppm;  ///< How much too fast its clock runs.
  double responder_ppm;
  double reply_s;  ///< From the reception of a message to the answer, by the answering clock.
};

/// Range by one message and its reply: half of what the initiator's clock saw pass beyond the
/// reply time that the responder tells. The clocks' difference acts on the whole reply:
/// about ½ c (e_initiator − e_responder) reply_s too long, 0.30 m for 10 ppm and 200 µs.
double SingleSidedRange_m(const RangingExchange& exchange);

/// Range by three messages, (R_a R_b − D_a D_b) / (R_a + R_b + D_a + D_b) of both sides' round
/// trips R and reply times D: wrong by the clocks' rate errors times the distance only. Source:
/// D. Neirynck, E. Luk & M. McLaughlin, "An alternative double-sided two-way ranging method",
/// WPNC 2016.
double DoubleSidedRange_m(const RangingExchange& exchange);

/// Error of an uncorrected DW1000 over free space, by the power that arrives at `distance_m`
/// (channel 5, 500 MHz, pulses at 64 MHz, the permitted -41.3 dBm/MHz): from −0.06 m at 3 m to
/// 0.08 m beyond 32 m. Source: Decawave APS011, table 2.
double PowerBias_m(double distance_m);

}  // namespace windhover
