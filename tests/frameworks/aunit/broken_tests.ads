--  Tests that end the program, or hang.

with AUnit;
with AUnit.Test_Cases;
with AUnit.Test_Suites;

package Broken_Tests is

   type Broken_Case is new AUnit.Test_Cases.Test_Case with null record;
   overriding procedure Register_Tests (Self : in out Broken_Case);
   overriding procedure Tear_Down (Self : in out Broken_Case);
   overriding function Name (Self : Broken_Case) return AUnit.Message_String;

   function Suite return AUnit.Test_Suites.Access_Test_Suite;

end Broken_Tests;
