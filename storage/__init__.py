"""Files that appear whole or not at all, sealed and checked; knows neither statistics nor physics."""
