module example.org/arm

go 1.19
