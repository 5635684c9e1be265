"""The page of a study: cards, sections, sliders, figures and their captions."""
