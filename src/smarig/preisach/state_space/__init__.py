"""The Preisach operator as a dynamical system (thesis Ch. 6): its state is a curve, its time is arbitrary.

    inputs 𝒰 ──F──▶ reduced memory sequences 𝒮 ──G──▶ boundaries ℬ ──r──▶ outputs
             ◀──Fʳ─                            ◀─G⁻¹─

``driving`` is u, ``memory_sequence`` s(u, τ), ``boundary`` B; ``maps`` joins them, ``transition`` is
φ (6.8), ``read_out`` r, ``rotation`` and ``metric`` make ℬ a metric space, ``reachability`` is Theorem 6.4
as a construction, ``operator_state`` speaks to ``smarig.preisach.operator``. ``Preisach`` is what runs in a
loop; this package is what can be proved, drawn and measured about it.
"""
