"""Contact in space of punches of any shape with stacks of any crystal cut, by convolution on a grid."""
