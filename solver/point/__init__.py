"""Contacts at a point with half-spaces and layered bodies: theory in docs/theory-points.md, cited here as *points*.

A case passes, in this order, through ``profile`` (the punch), ``system`` (Galerkin's equations of a layered body),
``state`` (loads and edges at a known radius), ``table`` (windows of radii), ``body`` (radius that carries a force),
``contact`` (cases in SI), ``slidingtable`` and ``sliding`` (friction), ``tractions``, ``waves`` and ``inside``
(fields), ``surface``, ``electrodes``, ``peaks`` and ``quantities``.
"""
