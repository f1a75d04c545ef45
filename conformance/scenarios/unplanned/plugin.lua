function TestCase.run()
  rtf.plan_cases({ "a", "b" })
  rtf.case("a", function() end)
end
