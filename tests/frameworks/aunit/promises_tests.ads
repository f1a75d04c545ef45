--  The cases of tests/frameworks/promises.json.

with AUnit;
with AUnit.Test_Cases;
with AUnit.Test_Suites;

package Promises_Tests is

   type Promises_Case is new AUnit.Test_Cases.Test_Case with null record;
   overriding procedure Register_Tests (Self : in out Promises_Case);
   overriding function Name (Self : Promises_Case) return AUnit.Message_String;

   function Suite return AUnit.Test_Suites.Access_Test_Suite;

end Promises_Tests;
