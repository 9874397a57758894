"""Reports of a study: the page of HTML, formulas with their values, headlines, sound."""
