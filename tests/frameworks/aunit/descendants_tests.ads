--  Cases that start processes, see tests/frameworks/descendants.

with AUnit;
with AUnit.Test_Cases;
with AUnit.Test_Suites;

package Descendants_Tests is

   type Descendants_Case is new AUnit.Test_Cases.Test_Case with null record;
   overriding procedure Register_Tests (Self : in out Descendants_Case);
   overriding function Name (Self : Descendants_Case) return AUnit.Message_String;

   --  One case passes, the other one fails.
   type Inner_Case is new AUnit.Test_Cases.Test_Case with null record;
   overriding procedure Register_Tests (Self : in out Inner_Case);
   overriding function Name (Self : Inner_Case) return AUnit.Message_String;

   function Suite return AUnit.Test_Suites.Access_Test_Suite;

end Descendants_Tests;
