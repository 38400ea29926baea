// SPDX-License-Identifier: GPL-3.0-or-later
// Tiles that soaks and fuzzers found: what rounding from tile to tile may not do to a merge.
#include "core/merge.hpp"

#include <gtest/gtest.h>

#include "support/merge_judge.hpp"

namespace terrane {
namespace {

TEST(Merge, AnEdgeThatATileRoundsPassesNoVertexBesideIt) {
  // The third tile rounds the first one's long edge where it crosses it, and so turns it, by less than an ulp, towards
  // the second one's tip far away.
  const Tin a{{{3333.333333333333, 3333.333333333333, 765},
               {6666.6666666666661, 0, 897},
               {3333.333333333333, 10000, 47}},
              {{0, 1, 2}}};
  const Tin b{{{5000, 5000, 7},
               {9976.7360179687694, 5481.7661335672692, 7},
               {9955.042057289098, 5668.9979151658181, 7}},
              {{0, 1, 2}}};
  const Tin c{{{3750, 7500, -174},
               {1459.716212502693, 8502.2974472316037, 92},
               {6040.2837874973065, 6497.7025527683963, 44}},
              {{0, 1, 2}}};
  const Tin d{{{4000, 4800, 5}, {9000, 4700, 5}, {9000, 5800, 5}}, {{0, 1, 2}}};
  for (std::vector<Tin> tiles : {std::vector{a, b, c}, std::vector{a, b, c, d}}) {
    for (Tin& tile : tiles) tile = canonical(tile);
    const MergeOptions options{Overlap::first, {}};
    Context context;
    EXPECT_EQ(support::broken_promises(tiles, options, merge(tiles, options, context)), "");
  }
}

TEST(Merge, TilesThatShareMostOfTheirFaces) {
  const std::vector<Point> v{{9, 14, 1},  {21, 47, -1}, {9, 59, -3}, {17, 73, 3}, {2, 94, -2}, {2, 96, -3},
                             {58, 55, 0}, {58, 64, 2},  {56, 94, 2}, {72, 97, 1}, {89, 34, 3}, {67, 4, 2}};
  const std::vector<Tin> tiles{
      canonical(Tin{v, {{0, 1, 3}, {0, 2, 4}, {0, 6, 7}, {0, 11, 6}, {5, 8, 9}, {8, 11, 9}, {9, 11, 10}}}),
      canonical(Tin{v, {{0, 2, 4}, {0, 6, 7}, {0, 11, 6}, {5, 8, 9}, {9, 11, 10}}})};
  for (const Overlap overlap : {Overlap::min, Overlap::mean}) {
    Context context;
    EXPECT_EQ(support::broken_promises(tiles, {overlap, {}}, merge(tiles, {overlap, {}}, context)), "");
  }
}

TEST(Merge, WhereAPlaceIsRoundedAnewTheFacesBesideItAreMendedToo) {
  const Tin a{{{335903.74792283837, 5002188.2000000002, 61.202969037897695},
               {336050.46435870935, 5001875.7000000002, 45.164822850232305},
               {335052.04999999999, 5003856.1191589925, 143.99368352557741},
               {334270.79999999999, 5008544.9723220915, -67.443926981930815},
               {335677.04999999999, 5007580.7869087094, 1.417171062582816},
               {338020.79999999999, 5005973.8112197397, -76.724235724077687}},
              {{0, 2, 1}, {0, 5, 2}, {3, 4, 5}}};
  const Tin b{{{333464.72505656845, 5002949.4246321069, 86.371877859186043},
               {334356.79702652519, 5002122.252035371, 161.0918748282084},
               {333333.29999999999, 5010000.7000000002, -97.713258716270133},
               {337129.10592343815, 5009068.7550155576, -133.68786965976093},
               {337365.87410889147, 5002297.9325862685, 101.55352045334166}},
              {{0, 1, 4}, {0, 3, 2}, {0, 4, 3}}};
  const Tin c{{{336050.46435870935, 5001875.7000000002, 45.164822850232305},
               {335903.74792283837, 5002188.2000000002, 61.202969037897695},
               {335052.04999999999, 5003856.1191589925, 143.99368352557741},
               {335023.44930761278, 5004063.2000000002, 144.65657760077281},
               {334270.79999999999, 5008544.9723220915, -67.443926981930815},
               {335677.04999999999, 5007580.7869087094, 1.417171062582816},
               {338020.79999999999, 5005973.8112197397, -76.724235724077687},
               {340833.29999999999, 5004045.4403929757, -172.43018519961851},
               {338718.92008745467, 5000313.2000000002, -37.292501798686686},
               {338561.55785509915, 5000000.7000000002, -15.352898464648394}},
              {{0, 1, 2}, {1, 3, 2}, {4, 5, 6}, {7, 8, 9}}};
  const std::vector<Tin> tiles{canonical(a), canonical(b), canonical(c)};
  const MergeOptions options{Overlap::min, {}};
  Context context;
  EXPECT_EQ(support::broken_promises(tiles, options, merge(tiles, options, context)), "");
}

TEST(Merge, AFaceMayGetBackALabelThatNoOtherHasAnyMore) {
  const Tin a{{{499999.99999999988, 4500000.0000000009, -2}, {500000.19999999995, 4500000.1999999983, 0},
               {500000.20000000001, 4499999.9999999991, 1}, {500000.39999999991, 4500000.0000000019, -1},
               {500000.79999999999, 4499999.9999999981, -2}, {500001.00000000006, 4500000.1999999983, -1},
               {500001.00000000006, 4499999.9999999991, 3}},
              {{0, 2, 1}, {1, 2, 3}, {4, 6, 5}}};
  const Tin b{{{500000, 4500000, 7}, {500000.48403949995, 4500000.0158437844, 7}, {500001, 4500000, 7}},
              {{0, 2, 1}}};
  const auto corner = [](double z) {
    return Tin{{{500000.20000000001, 4500000, z}, {500000.20000000001, 4500000.2000000002, z - 1},
                {500000.40000000002, 4500000, z - 2}},
               {{0, 2, 1}}};
  };
  std::vector<Tin> tiles{corner(0), corner(0), corner(1), a, b, corner(-1.5)};
  for (Tin& tile : tiles) tile = canonical(tile);
  const MergeOptions options{Overlap::max, {}};
  Context context;
  EXPECT_EQ(support::broken_promises(tiles, options, merge(tiles, options, context)), "");
}

TEST(Merge, AFaceOutsideATileReachesIntoItNoFartherThanRounding) {
  // The third tile's upper edge lies an ulp below those of the others: what is left above it is flipped away.
  const Tin a{{{500001.47723756672, 4500003.0563439848, -1},
               {500002.20506284107, 4500004.261313214, 3},
               {500004.74108885531, 4500004.3126158034, 3}},
              {{0, 2, 1}}};
  const Tin c{{{500001.47723756684, 4500003.0563439848, 0},
               {500002.20506284095, 4500004.2613132121, 4},
               {500004.74108885537, 4500004.3126158034, 4},
               {500005.33411043842, 4500002.5271015801, -1}},
              {{0, 2, 1}, {0, 3, 2}}};
  const Tin d{{{500001.47723756684, 4500003.0563439848, 0},
               {500002.20506284118, 4500004.261313214, 4},
               {500004.74108885537, 4500004.3126158016, 4},
               {500005.33411043847, 4500002.5271015773, -1}},
              {{0, 2, 1}, {0, 3, 2}}};
  const Tin e{{{500001.47723729024, 4500003.0563434791, 0},
               {500004.74108873296, 4500004.3126161993, 4},
               {500005.33411029004, 4500002.5271021957, -1}},
              {{0, 2, 1}}};
  const Tin f{{{500001.47723756684, 4500003.0563439848, 1},
               {500002.20506284118, 4500004.261313214, 5},
               {500004.74108885537, 4500004.3126158016, 5},
               {500005.33411043847, 4500002.5271015773, 0},
               {500006.33307749237, 4500001.4064676408, 4}},
              {{0, 2, 1}, {0, 3, 2}, {0, 4, 3}}};
  std::vector<Tin> tiles{a, a, c, d, e, f};
  for (Tin& tile : tiles) tile = canonical(tile);
  const MergeOptions options{Overlap::sum, {}};
  Context context;
  EXPECT_EQ(support::broken_promises(tiles, options, merge(tiles, options, context)), "");
}

TEST(Merge, AZeroPointOfAJumpPassesNoBorder) {
  const Tin a{{{333333.5034108957, 5000001.1421637712, 2}, {333333.71122110734, 5000001.182687711, -3},
               {333333.78438707138, 5000001.196955408, 0}, {333333.90254868194, 5000001.219997461, -3},
               {333333.9665195854, 5000001.2324720789, 3}},
              {{0, 4, 1}, {1, 3, 2}, {1, 4, 3}}};
  const Tin b{{{333333.71122110734, 5000001.182687711, -3}, {333333.89916711306, 5000001.2193380399, 3},
               {333333.90254868194, 5000001.219997461, -3}},
              {{0, 2, 1}}};
  const Tin c{{{333333.82331151399, 5000001.1936258646, -3}, {333333.70999509783, 5000001.2246103063, -1},
               {333333.67939447728, 5000001.2329775253, 1}, {333333.52616554138, 5000001.2748753643, 0},
               {333333.49927433475, 5000001.2822283059, 0}, {333333.46960586164, 5000001.2903406443, -2},
               {333334.20317409333, 5000001.0897589186, -3}},
              {{0, 2, 1}, {0, 6, 2}, {3, 5, 4}}};
  const Tin d{{{333333.29999999999, 5000000.7000000002, 46.69870630888596},
               {333333.29999999999, 5000001.7000000002, -173.12589236125075},
               {333334.29999999999, 5000000.7000000002, 2.1484652679560265}},
              {{0, 2, 1}}};
  const std::vector<Tin> tiles{canonical(a), canonical(b), canonical(c), canonical(d)};
  const MergeOptions options{Overlap::min, {}};
  Context context;
  EXPECT_EQ(support::broken_promises(tiles, options, merge(tiles, options, context)), "");
}

TEST(Merge, ACrossingBesideAnEqualTilesBorderPassesNoBorder) {
  const Tin a{{{0, 2500, 877.16792691654689},
               {1029.6762422617167, 7392.8281020409649, 459},
               {1047.7530186050089, 7388.9890173740514, 180.66534251346224}},
              {{0, 2, 1}}};
  const Tin b{{{-1000, 3500, 0}, {-1000, 5500, 0}, {1000, 5500, 0}}, {{0, 2, 1}}};
  const std::vector<Tin> tiles{canonical(a), canonical(b), canonical(a)};
  const MergeOptions options{Overlap::max, {}};
  Context context;
  EXPECT_EQ(support::broken_promises(tiles, options, merge(tiles, options, context)), "");
}

TEST(Merge, AWeldedCornerTiltsItsFaceByNoMoreThanWasWelded) {
  // The border of the second tile runs half a nanometre above the first one's, to where both are 151 high; the third
  // one crosses the first where that is 0.
  const Tin a{{{0, 0.25, -135.1076883591991}, {0.5, 0.75, 53}, {0.5, 0.25, 151.14007579166264}}, {{0, 2, 1}}};
  const Tin b{{{0, 0.25, 0},
               {0.5, 0.25000000049999999, 151.14007579166264},
               {0.50000000050000004, -0.24999999950000001, 0}},
              {{0, 2, 1}}};
  const Tin c{{{0.23333333333333331, 0.45833333333333337, 0},
               {0.34999999999999998, 0.57499999999999996, 0},
               {0.34999999999999998, 0.45833333333333337, 0}},
              {{0, 2, 1}}};
  const std::vector<Tin> tiles{canonical(a), canonical(b), canonical(c)};
  const MergeOptions options{Overlap::min, {}};
  Context context;
  EXPECT_EQ(support::broken_promises(tiles, options, merge(tiles, options, context)), "");
}

TEST(Merge, AZeroPointBeyondTheBorderGoesUnderNoOtherPart) {
  const Tin a{{{333337.37654515792, 5000003.500827631, 267.06412667945699},
               {333336.90913255233, 5000003.9106115317, 404.48615693626044},
               {333337.0614156904, 5000004.0428635245, 990.97232204000647},
               {333337.36598196655, 5000004.3073675102, 661.66270885945028},
               {333337.97511451889, 5000004.8363754824, 756.40458014304772}},
              {{0, 4, 3}, {1, 2, 4}}};
  const Tin b{{{333336.43821769755, 5000004.9308049558, 20.865801044227165},
               {333335.73093616497, 5000005.1202444453, 11.077584439957612},
               {333337.97891018476, 5000004.5182079254, 42.187442286415511}},
              {{0, 2, 1}}};
  const Tin c{{{333339.71949343494, 5000005.1434471849, 884.52907503654183},
               {333339.77706663602, 5000005.1539992513, 877.0501999366569},
               {333340.28290983645, 5000005.2467107009, -20.298367231611493}},
              {{0, 1, 2}}};
  const Tin d{{{333334.22354434669, 5000004.1361441221, 453.57274404633608},
               {333334.99406891188, 5000004.2773666382, -25.908856468474113},
               {333338.09298734763, 5000004.8453395115, 160.81724010284017}},
              {{0, 2, 1}}};
  const Tin e{{{333337.3614852, 5000003.3302551638, 432.33914506750534},
               {333336.90913255233, 5000003.9106115317, 405.48615693626044},
               {333337.0614156904, 5000004.0428635245, 991.97232204000647},
               {333337.21369882848, 5000004.1751155173, 380.41496995831517},
               {333337.36598196655, 5000004.3073675102, 662.66270885945028},
               {333337.97511451889, 5000004.8363754824, 757.40458014304772}},
              {{0, 4, 3}, {1, 2, 5}}};
  const std::vector<Tin> tiles{canonical(a), canonical(b), canonical(c), canonical(d), canonical(e)};
  const MergeOptions options{Overlap::max, {}};
  Context context;
  EXPECT_EQ(support::broken_promises(tiles, options, merge(tiles, options, context)), "");
}

TEST(Merge, ASurfaceThatJumpsKeepsItsHeightWhereASteeperOneCrossesIt) {
  // The slivers rise millions of metres per metre, and the surface jumps where the first has cut it.
  const Tin a{{{500000.27624528512, 4500000.4939529588, 2},
               {500000.06653820636, 4500000.6031032875, 3},
               {500000.17880853993, 4500000.9567327444, 1},
               {500000.76847234619, 4500000.7085130149, -2},
               {500000.50607050565, 4500000.3668333339, 1},
               {500000.92768101394, 4500000.1185498722, -1}},
              {{0, 2, 1}, {3, 4, 5}}};
  const Tin b{{{500000.36550277245, 4500000.5440378245, -68.749799527263733},
               {500000.1752417676, 4500000.6063327687, -106.31349351870062},
               {500000.62864871381, 4500000.4578766068, 2.1233409902171219}},
              {{0, 1, 2}}};
  const Tin c{{{500000.36550277245, 4500000.5440378245, -68.749799527263733},
               {500000.1752417676, 4500000.6063327687, -106.31349351870062},
               {500000.53677814128, 4500000.4879591474, -8.3301654688467988},
               {500000.62864871381, 4500000.4578766068, 2.1233409902171219}},
              {{0, 1, 3}, {0, 3, 2}}};
  const Tin d{{{500000.375, 4500000.8250000002, 7},
               {500000.68500528327, 4500000.7389002107, 7},
               {500000.72216205153, 4500000.3139234856, 7}},
              {{0, 2, 1}}};
  const std::vector<Tin> tiles{canonical(a), canonical(b), canonical(c), canonical(d)};
  const MergeOptions options{Overlap::min, {}};
  Context context;
  EXPECT_EQ(support::broken_promises(tiles, options, merge(tiles, options, context)), "");
}

TEST(Merge, ASliverThatRisesLittleAlongItsEdgesLiftsNoTerrain) {
  // The slivers rise 5e9 metres per metre, but less than the terrain along the edges that are cut where they cross it.
  // The edge of the last tile runs over the terrain beside them.
  const Tin terrain{{{19.289190248341637, 637.5395120970876, 61.394410551379195},
                     {500, 500, -129.89738824282153},
                     {95.320882984736514, 793.65764463358812, -11.352287826445078},
                     {956.65453877582206, 703.63357339947959, 187.66187947923916},
                     {998.76168429604047, 535.16791546533261, 165.03572476394763}},
                    {{0, 1, 2}, {1, 4, 3}}};
  const Tin slivers{{{58.648615959252858, 390.57955801325556, 264.42252378268086},
                     {171.20360126981504, 418.48434480126718, -61.241647831720812},
                     {322.96505370662288, 456.10925289087447, -95.533480931121531},
                     {559.92963973060364, 514.85783850311225, 98.5348366633404},
                     {806.31918314248423, 575.9430730022433, 814.70958661299608},
                     {985.02782659135983, 620.24876541377773, -76.860160357849878}},
                    {{0, 1, 2}, {3, 5, 4}}};
  Tin more_slivers = slivers;
  more_slivers.vertices.push_back({493.80493225451607, 498.46411007522062, 135.56058768391119});
  more_slivers.faces.push_back({6, 5, 3});
  const Tin cover{{{125, 375, 658.18552326920951},
                   {125, 1075, 241.69975129476018},
                   {625.51095930574434, 492.98926922323648, 767.46483755968688}},
                  {{0, 2, 1}}};
  const std::vector<Tin> tiles{canonical(terrain), canonical(slivers), canonical(more_slivers), canonical(cover)};
  const MergeOptions options{Overlap::min, {}};
  Context context;
  EXPECT_EQ(support::broken_promises(tiles, options, merge(tiles, options, context)), "");
}

TEST(Merge, ASliverFlippedAcrossTheLineWhereSurfacesCrossShowsEachWhereItIsHigher) {
  const std::vector<Tin> tiles{
      canonical(Tin{{{500000.03526269027, 4500005.078997138, -22.454359648064035},
                     {500005.75608372001, 4500004.810185181, 50.399963007944756},
                     {500004.3468100215, 4500001.2284062831, 50.692936267861363}},
                    {{0, 2, 1}}}),
      canonical(Tin{{{500004.00099999981, 4500003.0000005001, -89.473837080684433},
                     {500004.66766633315, 4500003.0006671669, 516.37837405427024},
                     {500005.00099949981, 4500003.0010005003, 320.76994833023031},
                     {500005.66766583314, 4500003.0016671661, 231.94321760972718}},
                    {{0, 3, 1}, {1, 3, 2}}}),
      canonical(Tin{{{500004.66666666669, 4500003, 516.87837405427024},
                     {500005, 4500003.333333333, 701.44979580042843},
                     {500005, 4500003, 321.26994833023031}},
                    {{0, 2, 1}}})};
  const MergeOptions options{Overlap::max, {}};
  Context context;
  EXPECT_EQ(support::broken_promises(tiles, options, merge(tiles, options, context)), "");
}

}  // namespace
}  // namespace terrane
