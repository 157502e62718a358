#include "metrics/ssimulacra2.hpp"

#include <cmath>

namespace sgi {
namespace {

// [channel][scale][norm 1, 4][map]: with fewer scales, channels follow each other sooner.
constexpr double kWeights[kVisualChannels * kVisualScales * 2 * kVisualMaps] = {
    0,
    0.0007376606707406586,
    0,
    0,
    0.0007793481682867309,
    0,
    0,
    0.0004371155730107379,
    0,
    1.1041726426657346,
    0.00066284834129271,
    0.00015231632783718752,
    0,
    0.0016406437456599754,
    0,
    1.8422455520539298,
    11.441172603757666,
    0,
    0.0007989109436015163,
    0.000176816438078653,
    0,
    1.8787594979546387,
    10.94906990605142,
    0,
    0.0007289346991508072,
    0.9677937080626833,
    0,
    0.00014003424285435884,
    0.9981766977854967,
    0.00031949755934435053,
    0.0004550992113792063,
    0,
    0,
    0.0013648766163243398,
    0,
    0,
    0,
    0,
    0,
    7.466890328078848,
    0,
    17.445833984131262,
    0.0006235601634041466,
    0,
    0,
    6.683678146179332,
    0.00037724407979611296,
    1.027889937768264,
    225.20515300849274,
    0,
    0,
    19.213238186143016,
    0.0011401524586618361,
    0.001237755635509985,
    176.39317598450694,
    0,
    0,
    24.43300999870476,
    0.28520802612117757,
    0.0004485436923833408,
    0,
    0,
    0,
    34.77906344483772,
    44.835625328877896,
    0,
    0,
    0,
    0,
    0,
    0,
    0,
    0,
    0.0008680556573291698,
    0,
    0,
    0,
    0,
    0,
    0.0005313191874358747,
    0,
    0.00016533814161379112,
    0,
    0,
    0,
    0,
    0,
    0.0004179171803251336,
    0.0017290828234722833,
    0,
    0.0020827005846636437,
    0,
    0,
    8.826982764996862,
    23.19243343998926,
    0,
    95.1080498811086,
    0.9863978034400682,
    0.9834382792465353,
    0.0012286405048278493,
    171.2667255897307,
    0.9807858872435379,
    0,
    0,
    0,
    0.0005130064588990679,
    0,
    0.00010854057858411537,
};

constexpr double kNothing = 1e-30;  // of a mean of fourth powers in floats

double weight(int scales, int scale, int channel, int norm, int map) {
  return kWeights[((channel * scales + scale) * 2 + norm) * kVisualMaps + map];
}

// The curve from weighted norms to the score, fitted to what people said.
struct Curve {
  double score = 100, slope = 0;

  explicit Curve(double norms) {
    constexpr double kScale = 0.9562382616834844, kPower = 0.6276336467831387;
    constexpr double kOne = 2.326765642916932, kTwo = -0.020884521182843837, kThree = 6.248496625763138e-05;
    const double t = kScale * norms, bent = t * (kOne + t * (kTwo + t * kThree));
    if (!(bent > 0)) return;
    score = 100 - 10 * std::pow(bent, kPower);
    slope = -10 * kPower * std::pow(bent, kPower - 1) * (kOne + t * (2 * kTwo + t * 3 * kThree)) * kScale;
  }
};

}  // namespace

bool counts(int scales, int scale, int channel, VisualMap map) {
  return weight(scales, scale, channel, 0, map) > 0 || weight(scales, scale, channel, 1, map) > 0;
}

double visual_score(const std::vector<ChannelSums> &sums, const std::vector<int64_t> &pixels,
                    std::vector<ChannelSlopes> *slopes) {
  const int scales = int(sums.size());
  const auto each = [&](const auto &visit) {
    for (int scale = 0; scale < scales; ++scale)
      for (int channel = 0; channel < kVisualChannels; ++channel)
        for (int map = 0; map < kVisualMaps; ++map) {
          const double *sum = &sums[scale][channel].sum[2 * map], share = 1.0 / double(pixels[scale]);
          visit(scale, channel, map, weight(scales, scale, channel, 0, map), sum[0] * share,
                weight(scales, scale, channel, 1, map), sum[1] * share);
        }
  };
  double norms = 0;
  each([&](int, int, int, double one, double mean, double four, double mean_four) {
    norms += one * mean + four * std::sqrt(std::sqrt(mean_four));
  });
  const Curve curve(norms);
  if (!slopes) return curve.score;
  slopes->assign(scales, ChannelSlopes{});
  each([&](int scale, int channel, int map, double one, double, double four, double mean_four) {
    const double share = curve.slope / double(pixels[scale]);
    const double cubic = mean_four > kNothing ? four * std::pow(mean_four, -0.75) : 0.0;
    (*slopes)[scale][channel][map] = {float(share * one), float(share * cubic)};
  });
  return curve.score;
}

}  // namespace sgi
