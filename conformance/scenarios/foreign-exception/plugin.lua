function TestCase.run()
  error({ code = 42 })
end
