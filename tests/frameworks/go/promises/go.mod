module example.org/promises

go 1.25
