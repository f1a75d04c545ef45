module example.org/descendants

go 1.20
