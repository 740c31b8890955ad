"""`sgcad desk`: cases of a results folder in a browser, to see which to trust and to correct the others.

`index` keeps the list's rows of a folder in memory; `views` has rows, filters, and the contents of a case's page;
`mending` applies a person's edits to a case in a process of its own; `guard` refuses foreign requests; `pages`,
`changes` and `app` serve the pages; `command` is the command line.
"""
