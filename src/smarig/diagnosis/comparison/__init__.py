"""Model comparison: hypotheses about a record compete only by predicting blocks of it that they have not seen.

Theory of operation. A record is readings in blocks, about an excursion each. A hypothesis is a set of parts: effects
of the catalogue, and smooth dependences on a variable (time, cycle, rate, level, history). Beside its parts each
hypothesis has a density of the hysteresis, with one prior for all, so that none gains by the density.

1. Fit: y = density + parts + noise. All but the parameters of effects is Gaussian, with the likeliest variances, so
   one factorisation predicts each block from all others (``block_predictions``, ``gaussian_fit``).
2. Score: log p(block | all others), less a nat for each parameter that is fitted to all blocks
   (``compared_hypothesis``).
3. Weigh: priors times scores, over resampled blocks; ½ on nothing, the rest on single parts and pairs (``weights``).
4. Decide: the probability and the size of each part, and what runs say that no fit has seen, by one table of rules
   (``verdict_rules``).
5. Tell: findings are values (``finding``); words come last (``verdict_sentences``).

What a record is differs, and only that: in ``commanded`` a current heats a wire, in ``measured`` the input was read
too, in ``thermal`` the power gives the temperature of a wire. Each says which hypotheses are tried, how they become
predictions, and how a law extends the model.

What is named changes with a row of ``verdict_rules.RULES``. A new effect is a file of ``plant.effects``; a new variable
is a shape of ``commanded.kernel_shapes`` and a feature of ``measured.plain_variables``.
"""
