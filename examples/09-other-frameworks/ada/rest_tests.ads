--  AUnit: the arm at rest.

with AUnit;
with AUnit.Test_Cases;
with AUnit.Test_Suites;

package Rest_Tests is

   type Rest_Case is new AUnit.Test_Cases.Test_Case with null record;
   overriding procedure Register_Tests (Self : in out Rest_Case);
   overriding function Name (Self : Rest_Case) return AUnit.Message_String;

   function Suite return AUnit.Test_Suites.Access_Test_Suite;

end Rest_Tests;
