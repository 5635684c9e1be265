"""What the variables of the surrogates' files mean, for those who open them with another program."""

#: Meanings. "Over its unit" makes a plain number of what has another unit for every input or output.
MEANINGS = {
    "input": "name of an input",
    "other_input": "name of another input",
    "output": "name of an output",
    "units": "unit of every output",
    "case": "number of a case",
    "decile": "decile of the cases by the value of an input",
    "mode": "degree of the Chebyshev polynomial",
    "position": "position along an input, from -1 at its lower to 1 at its upper bound, in its scale",
    # models
    "low": "lower bound of every input, over its unit in input_units",
    "high": "upper bound of every input, over its unit in input_units",
    "scale": "scale of every input: linear or log",
    "input_units": "unit of every input",
    "input_long_name": "meaning of every input",
    "output_units": "unit of every output",
    "output_long_name": "meaning of every output",
    "probe_point": "inputs of predictions that a reader repeats, over their units in input_units",
    "probe_mean": "predicted means that a reader repeats, over their units in output_units",
    "probe_std": "predicted standard deviations that a reader repeats, over their units in output_units",
    "hyperparameter": "parameter of the kernel along every input",
    "contraction_order": "order in which the cores are contracted",
    "amplitude": "amplitude of the kernel along every input",
    "variance": "variance of every standardised output, or of every output over its unit in units squared",
    "output_offset": "what is subtracted from every output to standardise it, over its unit in output_units",
    "output_scale": "what every output is divided by to standardise it, over its unit in output_units",
    "levels": "levels of an input in the training data, scaled to -1 to 1",
    "core": "core of the tensor train of the posterior mean's coefficients",
    "calibration_weights": "calibration: weight of every part of the variance",
    "calibration_floor": "calibration: variance that is added, over the square of the unit in output_units",
    "calibration_trend": "calibration: coefficients of the logarithm of the standard deviation's factor",
    "calibration_guard": "calibration: what is added to that logarithm in slabs of every input",
    "point": "inputs of the training cases, over their units in input_units",
    "value": "values of the training cases or of the inputs, over their units",
    "theta": "logarithms of the kernel's hyperparameters for every output",
    # validation
    "range": "range of the truth, over its unit in units",
    "exact": "exact output, over its unit in units",
    "predicted": "predicted output, over its unit in units",
    "std": "predicted standard deviation, over its unit in units",
    "kinked": "1 where the coefficients do not decay geometrically",
    # sensitivity
    "mean": "mean of every output over the box, over its unit in units",
    "second_order": "Sobol' index of two inputs together",
    "main_effect": "mean of an output given one input less its mean over the box, over its unit in units",
    "main_effect_std": "root-mean-square predicted standard deviation given one input, over its unit in units",
    "first_order": "Sobol' index of first order",
    "first_order_low": "lower bound of the Sobol' index of first order, given the model's error",
    "first_order_high": "upper bound of the Sobol' index of first order, given the model's error",
    "total": "total Sobol' index",
    "total_low": "lower bound of the total Sobol' index, given the model's error",
    "total_high": "upper bound of the total Sobol' index, given the model's error",
}

#: How their contents were made.
SOURCE = "meecontact: Gaussian-process regression on exact cases"
